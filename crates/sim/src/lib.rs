//! Simulations: the paper's hotel, and small buildings of many kinds, each with one property that deceives place recognition. They
//! ask a server over HTTP like any other client.

pub mod buildings;
pub mod hotel;

use revisit_api as api;
use revisit_client as client;
use revisit_core::{domain, geometry, named, recognition, vocabulary};

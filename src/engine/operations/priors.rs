//! Prior anchors: what a plan shows is put.

use super::views;
use crate::domain::ids::MapId;
use crate::domain::invalid::FieldError;
use crate::domain::prior::{NewPrior, id_form, is_servers_form};
use crate::domain::report::AnchorReport;
use crate::engine::error::refuse;
use crate::engine::limits::quota::check_prior;
use crate::engine::maps::live::Decision;
use crate::engine::{Result, Service, ServiceError, Stored};
use crate::recognition::anchors::prior_anchors::{MAX_PRIORS, add_prior, prior_as_sent, prior_faults};
use crate::recognition::map::index::MapIndex;

impl Service {
    /// Puts a prior anchor, or finds that this very request had done so.
    pub async fn put_prior(&self, map: &MapId, new: NewPrior) -> Result<Stored<AnchorReport>> {
        check_id(&new)?;
        let live = self.live(map).await?;
        let room = self.room(live.owner).await?;
        let decide = move |index: &mut MapIndex| {
            if let Some(seq) = index.priors().by_id(&new.id) {
                if prior_as_sent(index, seq).as_ref() != Some(&new) {
                    return Err(exists(&new));
                }
                return Ok(Decision::Unchanged((false, views::anchor(index, seq))));
            }
            refuse(prior_faults(index, &new))?;
            if index.priors().len() >= MAX_PRIORS {
                return Err(ServiceError::MapFull(format!(
                    "the map holds {MAX_PRIORS} prior anchors, and may hold no more"
                )));
            }
            check_prior(&room, index, &new)?;
            let (seq, decided) = add_prior(index, &new);
            Ok(Decision::Changed((true, views::anchor(index, seq)), decided, None))
        };
        let ((created, value), map_version) = self.change(&live, decide).await?;
        let value = value
            .ok_or_else(|| ServiceError::Internal("a prior anchor vanished under the lock".to_owned()))?;
        Ok(Stored { created, map_version, value })
    }
}

/// Rejects a name that the server may give to an anchor of its own.
fn check_id(new: &NewPrior) -> Result<()> {
    if !is_servers_form(new.id.as_str()) {
        return Ok(());
    }
    let fault = FieldError::new("{anchor}", "the server names anchors so itself");
    Err(fault.got(&new.id).limit(id_form()).into())
}

fn exists(new: &NewPrior) -> ServiceError {
    let detail = format!(
        "prior anchor {} exists and was sent with another body; delete it first if the plan has changed",
        new.id
    );
    ServiceError::Conflict { code: "prior_exists", detail }
}

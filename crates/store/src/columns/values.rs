//! Values of the model in columns: as what each of them stands there, on the way in and on the way out.
//!
//! Ids, and names of which there are few, are text. Numbers of the map's are integers. Vectors are packed.

use std::sync::Arc;

use revisit_core::domain::erasure::ErasureState;
use revisit_core::domain::event::EventKind;
use revisit_core::domain::global_descriptor::GlobalEncoding;
use revisit_core::domain::ids::{
    AnchorSeq, GlobalModelId, JudgementId, KeyframeId, KeyframeSeq, LoopId, MapId, PriorId, ReleaseName,
    SessionId, SessionSeq, StoredId as _,
};
use revisit_core::domain::judgement::{Asks, JobState, TextFunction};
use revisit_core::domain::key::KeySeq;
use revisit_core::domain::reason::ReasonCode;
use revisit_core::domain::verdict::Decision;
use revisit_core::geometry::{Gravity, Point3, Pose, Sim3};
use sqlx::Error;
use sqlx::error::BoxDynError;
use sqlx::postgres::PgRow;
use sqlx::sqlite::SqliteRow;

use crate::columns::blob::{pack, unpack_array};
use crate::sql::row::{FromValue, column_error};
use crate::sql::value::{ToValue, Value};

/// Reads types from columns of a type that both engines know.
macro_rules! reads {
    ($($type:ty, from $column:ty: $convert:expr;)*) => {
        $(impl<'r> FromValue<'r> for $type {
            fn from_sqlite(row: &'r SqliteRow, place: usize) -> Result<Self, Error> {
                let value = <$column>::from_sqlite(row, place)?;
                convert(value, $convert).map_err(|error| column_error(row, place, error))
            }

            fn from_postgres(row: &'r PgRow, place: usize) -> Result<Option<Self>, Error> {
                let value = <$column>::from_postgres(row, place)?;
                let read = value.map(|value| convert(value, $convert)).transpose();
                read.map_err(|error| column_error(row, place, error))
            }
        })*
    };
}

/// Writes types to columns as another one.
macro_rules! writes {
    ($($type:ty, as $column:ty: $convert:expr;)*) => {
        $(impl ToValue for $type {
            const NULL: Value = <$column>::NULL;

            fn to_value(self) -> Value {
                let convert: fn($type) -> $column = $convert;
                convert(self).to_value()
            }
        })*
    };
}

fn convert<C, T>(value: C, convert: fn(C) -> Result<T, BoxDynError>) -> Result<T, BoxDynError> {
    convert(value)
}

macro_rules! numbers {
    ($($name:ident of $number:ty),*) => {
        reads!($($name, from $number: |number| Ok($name(number));)*);
        writes!($($name, as $number: |of| of.0;)*);
    };
}

numbers!(KeyframeSeq of u32, AnchorSeq of u32, SessionSeq of u32, KeySeq of i64);

// Counts of what there is. None comes near the largest of a column.
reads!(u64, from i64: |number| Ok(Self::try_from(number)?););
writes! {
    u64, as i64: |number| i64::try_from(number).unwrap_or(i64::MAX);
    usize, as i64: |number| i64::try_from(number).unwrap_or(i64::MAX);
}

macro_rules! ids {
    ($($name:ident),*) => {
        reads!($($name, from &'r str: |text| {
            $name::stored(text).map_err(|error| format!("{text:?}: {error}").into())
        };)*);
        $(impl ToValue for &$name {
            const NULL: Value = Value::Text(None);

            fn to_value(self) -> Value {
                self.as_str().to_value()
            }
        })*
    };
}

ids!(MapId, ReleaseName, KeyframeId, SessionId, LoopId, PriorId, JudgementId, GlobalModelId);

macro_rules! named {
    ($($name:ident),*) => {
        reads!($($name, from &'r str: |text| {
            $name::from_name(text).ok_or_else(|| format!("{text:?} is none that is known").into())
        };)*);
        writes!($($name, as &'static str: |of| of.as_str();)*);
    };
}

named!(ErasureState, EventKind, GlobalEncoding, Asks, JobState, TextFunction, ReasonCode, Decision);

reads! {
    Box<str>, from &'r str: |text| Ok(text.into());
    Arc<str>, from &'r str: |text| Ok(text.into());
}

impl ToValue for &Box<str> {
    const NULL: Value = Value::Text(None);

    fn to_value(self) -> Value {
        (**self).to_value()
    }
}

impl ToValue for &Arc<str> {
    const NULL: Value = Value::Text(None);

    fn to_value(self) -> Value {
        (**self).to_value()
    }
}

reads! {
    [u8; 32], from &'r [u8]: |bytes| bytes.try_into().map_err(|_| "a digest of another length".into());
    [f64; 3], from &'r [u8]: |bytes| Ok(unpack_array(bytes)?);
    [f64; 4], from &'r [u8]: |bytes| Ok(unpack_array(bytes)?);
    Point3, from &'r [u8]: |bytes| Ok(Self::from(unpack_array::<f64, 3>(bytes)?));
    Pose, from &'r [u8]: |bytes| {
        let [x, y, z, qx, qy, qz, qw] = unpack_array(bytes)?;
        Ok(Self::from_stored([x, y, z], [qx, qy, qz, qw]))
    };
    Sim3, from &'r [u8]: |bytes| {
        let [scale, x, y, z, qx, qy, qz, qw] = unpack_array(bytes)?;
        Ok(Self::scaled(Pose::from_stored([x, y, z], [qx, qy, qz, qw]), scale))
    };
    Gravity, from &'r [u8]: |bytes| {
        Self::new(unpack_array(bytes)?).ok_or_else(|| "no unit vector".into())
    };
}

writes! {
    [f64; 3], as Vec<u8>: pack;
    [f64; 4], as Vec<u8>: pack;
    Point3, as Vec<u8>: |at| pack([at.x, at.y, at.z]);
    &Pose, as Vec<u8>: |pose| pack(pose.translation_m().into_iter().chain(pose.rotation_xyzw()));
    &Sim3, as Vec<u8>: |of| {
        let ([x, y, z], [qx, qy, qz, qw]) = (of.translation_m(), of.rotation_xyzw());
        pack([of.scale(), x, y, z, qx, qy, qz, qw])
    };
    Gravity, as Vec<u8>: |gravity| pack(gravity.as_given());
}

//! Values of a statement, of the four kinds that both engines store.

use std::borrow::Cow;

use bytes::Bytes;
use sqlx::Arguments as _;
use sqlx::error::BoxDynError;
use sqlx::postgres::PgArguments;
use sqlx::sqlite::SqliteArguments;

/// A value; `None` of each kind is SQL's null. PostgreSQL wants to know of which type a null is.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Value {
    /// `bigint` of PostgreSQL, `integer` of SQLite; a truth value is 0 or 1.
    Integer(Option<i64>),
    /// `double precision` of PostgreSQL, `real` of SQLite.
    Real(Option<f64>),
    Text(Option<String>),
    /// `bytea` of PostgreSQL, `blob` of SQLite.
    Blob(Option<Vec<u8>>),
}

impl Value {
    pub(crate) fn add_to_sqlite(self, arguments: &mut SqliteArguments) -> Result<(), BoxDynError> {
        match self {
            Self::Integer(value) => arguments.add(value),
            Self::Real(value) => arguments.add(value),
            Self::Text(value) => arguments.add(value),
            Self::Blob(value) => arguments.add(value),
        }
    }

    pub(crate) fn add_to_postgres(self, arguments: &mut PgArguments) -> Result<(), BoxDynError> {
        match self {
            Self::Integer(value) => arguments.add(value),
            Self::Real(value) => arguments.add(value),
            Self::Text(value) => arguments.add(value),
            Self::Blob(value) => arguments.add(value),
        }
    }
}

/// Values of a statement's parameters, in their order.
pub(crate) trait Values {
    fn to_values(self) -> Vec<Value>;
}

macro_rules! tuples {
    ($(($($name:ident)+))*) => {
        $(impl<$($name: ToValue),+> Values for ($($name,)+) {
            fn to_values(self) -> Vec<Value> {
                #[expect(non_snake_case, reason = "a value has the name of its type")]
                let ($($name,)+) = self;
                vec![$($name.to_value()),+]
            }
        })*
    };
}

tuples! {
    (A)
    (A B)
    (A B C)
    (A B C D)
    (A B C D E)
    (A B C D E F)
    (A B C D E F G)
    (A B C D E F G H)
    (A B C D E F G H I)
    (A B C D E F G H I J)
    (A B C D E F G H I J K)
    (A B C D E F G H I J K L)
    (A B C D E F G H I J K L M)
    (A B C D E F G H I J K L M N)
}

/// A type whose values a statement takes.
pub(crate) trait ToValue {
    /// The null of its kind.
    const NULL: Value;

    fn to_value(self) -> Value;
}

macro_rules! values {
    ($kind:ident: $($from:ty => $to:expr),* $(,)?) => {
        $(impl ToValue for $from {
            const NULL: Value = Value::$kind(None);

            fn to_value(self) -> Value {
                let convert: fn($from) -> _ = $to;
                Value::$kind(Some(convert(self)))
            }
        })*
    };
}

values!(Integer: i64 => |of| of, i32 => i64::from, u32 => i64::from, u16 => i64::from, u8 => i64::from, bool => i64::from);
values!(Real: f64 => |of| of, f32 => f64::from);
values!(Text: String => |of| of, &str => str::to_owned, &String => String::clone, Cow<'_, str> => |of| of.into_owned(), Box<str> => |of| of.into_string());
values!(Blob: Vec<u8> => |of| of, &[u8] => <[u8]>::to_vec, &Vec<u8> => Vec::clone, &Bytes => |of| of.to_vec());

impl<const N: usize> ToValue for &[u8; N] {
    const NULL: Value = Value::Blob(None);

    fn to_value(self) -> Value {
        Value::Blob(Some(self.to_vec()))
    }
}

impl<T: ToValue> ToValue for Option<T> {
    const NULL: Value = T::NULL;

    fn to_value(self) -> Value {
        self.map_or(T::NULL, T::to_value)
    }
}

impl<T: ToValue + Clone> ToValue for &Option<T> {
    const NULL: Value = T::NULL;

    fn to_value(self) -> Value {
        self.clone().to_value()
    }
}

impl ToValue for &i64 {
    const NULL: Value = Value::Integer(None);

    fn to_value(self) -> Value {
        Value::Integer(Some(*self))
    }
}

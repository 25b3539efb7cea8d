//! Rows of either engine, read by name or by place.

use sqlx::error::BoxDynError;
use sqlx::postgres::PgRow;
use sqlx::sqlite::SqliteRow;
use sqlx::{Column as _, Decode, Error, Postgres, Row as _, Sqlite, Type, TypeInfo as _, ValueRef as _};

use super::cell::Cell;

/// A row of an answer.
pub(crate) enum Row {
    Sqlite(SqliteRow),
    Postgres(PgRow),
}

/// The place of a value in a row, or its column's name.
pub(crate) trait Index: Copy {
    fn place(self, row: &Row) -> Result<usize, Error>;
}

impl Index for usize {
    fn place(self, _row: &Row) -> Result<usize, Error> {
        Ok(self)
    }
}

impl Index for &str {
    fn place(self, row: &Row) -> Result<usize, Error> {
        match row {
            Row::Sqlite(row) => row.try_column(self).map(sqlx::Column::ordinal),
            Row::Postgres(row) => row.try_column(self).map(sqlx::Column::ordinal),
        }
    }
}

/// A type whose values a row holds. `'r` is the row's life, for texts and bytes that are borrowed from it.
pub(crate) trait FromValue<'r>: Sized {
    fn from_sqlite(row: &'r SqliteRow, place: usize) -> Result<Self, Error>;

    /// Reads it, `None` if it is null.
    fn from_postgres(row: &'r PgRow, place: usize) -> Result<Option<Self>, Error>;
}

impl Row {
    /// Returns a value.
    pub(crate) fn try_get<'r, T: FromValue<'r>, I: Index>(&'r self, at: I) -> Result<T, Error> {
        let place = at.place(self)?;
        match self {
            Self::Sqlite(row) => T::from_sqlite(row, place),
            Self::Postgres(row) => T::from_postgres(row, place)?
                .ok_or_else(|| column_error(row, place, Box::new(sqlx::error::UnexpectedNullError))),
        }
    }

    /// Returns the columns and values as they are.
    pub(crate) fn cells(&self) -> Result<(Vec<String>, Vec<Cell>), Error> {
        let names: Vec<String> = match self {
            Self::Sqlite(row) => row.columns().iter().map(|column| column.name().to_owned()).collect(),
            Self::Postgres(row) => row.columns().iter().map(|column| column.name().to_owned()).collect(),
        };
        let cells = (0..names.len()).map(|place| self.cell(place)).collect::<Result<_, _>>()?;
        Ok((names, cells))
    }

    fn cell(&self, place: usize) -> Result<Cell, Error> {
        let (is_null, kind) = match self {
            Self::Sqlite(row) => {
                let value = row.try_get_raw(place)?;
                (value.is_null(), value.type_info().name().to_owned())
            }
            Self::Postgres(row) => {
                let value = row.try_get_raw(place)?;
                (value.is_null(), value.type_info().name().to_owned())
            }
        };
        if is_null {
            return Ok(Cell::Null);
        }
        Ok(match kind.as_str() {
            "INTEGER" | "BOOLEAN" | "INT8" => Cell::Integer(self.try_get(place)?),
            "REAL" | "FLOAT8" => Cell::Real(self.try_get(place)?),
            "TEXT" => Cell::Text(self.try_get(place)?),
            "BLOB" | "BYTEA" => Cell::Blob(self.try_get(place)?),
            other => return Err(Error::Decode(format!("a column of type {other}").into())),
        })
    }
}

/// Names the column of a value that is none of the type that was asked for.
pub(crate) fn column_error<R: sqlx::Row>(row: &R, place: usize, source: BoxDynError) -> Error {
    let index =
        row.columns().get(place).map_or_else(|| place.to_string(), |column| format!("{:?}", column.name()));
    Error::ColumnDecode { index, source }
}

/// Returns a value of PostgreSQL as a type of Rust that the caller knows it to be of.
fn decoded<'r, T: Decode<'r, Postgres> + Type<Postgres>>(
    row: &'r PgRow,
    place: usize,
) -> Result<Option<T>, Error> {
    row.try_get::<Option<T>, _>(place)
}

/// Returns an integer of any width, or a truth value: tables of ours hold `bigint`, but expressions have other types.
fn integer(row: &PgRow, place: usize) -> Result<Option<i64>, Error> {
    let kind = row.try_get_raw(place)?.type_info().name().to_owned();
    Ok(match kind.as_str() {
        "INT4" => decoded::<i32>(row, place)?.map(i64::from),
        "INT2" => decoded::<i16>(row, place)?.map(i64::from),
        "BOOL" => decoded::<bool>(row, place)?.map(i64::from),
        _ => decoded::<i64>(row, place)?,
    })
}

macro_rules! integers {
    ($($type:ty),*) => {
        $(impl FromValue<'_> for $type {
            fn from_sqlite(row: &SqliteRow, place: usize) -> Result<Self, Error> {
                row.try_get(place)
            }

            fn from_postgres(row: &PgRow, place: usize) -> Result<Option<Self>, Error> {
                let number = integer(row, place)?.map(Self::try_from).transpose();
                number.map_err(|error| column_error(row, place, error.into()))
            }
        })*
    };
}

integers!(i64, i32, u32, u16, u8);

impl FromValue<'_> for bool {
    fn from_sqlite(row: &SqliteRow, place: usize) -> Result<Self, Error> {
        row.try_get(place)
    }

    fn from_postgres(row: &PgRow, place: usize) -> Result<Option<Self>, Error> {
        Ok(integer(row, place)?.map(|number| number != 0))
    }
}

impl FromValue<'_> for f32 {
    fn from_sqlite(row: &SqliteRow, place: usize) -> Result<Self, Error> {
        row.try_get(place)
    }

    fn from_postgres(row: &PgRow, place: usize) -> Result<Option<Self>, Error> {
        Ok(decoded::<f64>(row, place)?.map(|number| number as Self))
    }
}

macro_rules! as_they_are {
    ($($type:ty),*) => {
        $(impl<'r> FromValue<'r> for $type
        where
            $type: Decode<'r, Sqlite> + Type<Sqlite> + Decode<'r, Postgres> + Type<Postgres>,
        {
            fn from_sqlite(row: &'r SqliteRow, place: usize) -> Result<Self, Error> {
                row.try_get(place)
            }

            fn from_postgres(row: &'r PgRow, place: usize) -> Result<Option<Self>, Error> {
                decoded(row, place)
            }
        })*
    };
}

as_they_are!(f64, String, &'r str, Vec<u8>, &'r [u8]);

impl<'r, T: FromValue<'r>> FromValue<'r> for Option<T> {
    fn from_sqlite(row: &'r SqliteRow, place: usize) -> Result<Self, Error> {
        if row.try_get_raw(place)?.is_null() { Ok(None) } else { T::from_sqlite(row, place).map(Some) }
    }

    fn from_postgres(row: &'r PgRow, place: usize) -> Result<Option<Self>, Error> {
        T::from_postgres(row, place).map(Some)
    }
}

/// A type that a whole row is read into.
pub(crate) trait FromRow: Sized {
    fn from_row(row: &Row) -> Result<Self, Error>;
}

macro_rules! tuples {
    ($(($($name:ident $place:tt),+))*) => {
        $(impl<$($name: for<'r> FromValue<'r>),+> FromRow for ($($name,)+) {
            fn from_row(row: &Row) -> Result<Self, Error> {
                Ok(($(row.try_get::<$name, _>($place)?,)+))
            }
        })*
    };
}

tuples! {
    (A 0)
    (A 0, B 1)
    (A 0, B 1, C 2)
    (A 0, B 1, C 2, D 3)
    (A 0, B 1, C 2, D 3, E 4)
    (A 0, B 1, C 2, D 3, E 4, F 5)
    (A 0, B 1, C 2, D 3, E 4, F 5, G 6)
    (A 0, B 1, C 2, D 3, E 4, F 5, G 6, H 7)
    (A 0, B 1, C 2, D 3, E 4, F 5, G 6, H 7, I 8)
}

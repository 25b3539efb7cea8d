//! Operation: a function of the client for each operation that is a path, perhaps a body, and an answer.

/// Functions of [`super::Client`], a row each: how it asks, its name with the ids in its path, the path, its body's shape and its
/// answer's.
///
/// | it asks | |
/// |---|---|
/// | `read` | GET |
/// | `list` | GET of a part of a list |
/// | `put`, `post` | the answer says whether the same was written before |
/// | `send`, `patch` | POST and PATCH, whose answer does not |
/// | `remove` | DELETE, with an answer or without one |
macro_rules! operations {
    ($($(#[$doc:meta])* $asks:ident $name:ident($($id:ident),*) [$($step:expr),+] $($shape:ty),*;)+) => {
        impl $crate::Client {
            $($crate::operation::operation! { $asks $(#[$doc])* $name($($id),*) [$($step),+] $($shape),* })+
        }
    };
}

macro_rules! operation {
    (read $($row:tt)+) => { $crate::operation::operation! { ask GET $($row)+ } };
    (ask $method:ident $(#[$doc:meta])* $name:ident($($id:ident),*) [$($step:expr),+] $answer:ty) => {
        $(#[$doc])*
        pub async fn $name(&self, $($id: &str),*) -> Result<$answer, $crate::ClientError> {
            self.ask(reqwest::Method::$method, &[$($step),+], &[]).await?.decode()
        }
    };
    (list $(#[$doc:meta])* $name:ident($($id:ident),*) [$($step:expr),+] $answer:ty) => {
        $(#[$doc])*
        pub async fn $name(
            &self,
            $($id: &str,)*
            page: &$crate::Page,
        ) -> Result<$answer, $crate::ClientError> {
            self.read(&[$($step),+], &page.parameters()).await
        }
    };
    (put $($row:tt)+) => { $crate::operation::operation! { write PUT $($row)+ } };
    (post $($row:tt)+) => { $crate::operation::operation! { write POST $($row)+ } };
    (write $method:ident $(#[$doc:meta])* $name:ident($($id:ident),*) [$($step:expr),+] $body:ty, $answer:ty) => {
        $(#[$doc])*
        pub async fn $name(
            &self,
            $($id: &str,)*
            body: &impl $crate::Body<$body>,
        ) -> Result<$crate::Written<$answer>, $crate::ClientError> {
            self.write(reqwest::Method::$method, &[$($step),+], &[], body).await
        }
    };
    (send $($row:tt)+) => { $crate::operation::operation! { answer POST $($row)+ } };
    (patch $($row:tt)+) => { $crate::operation::operation! { answer PATCH $($row)+ } };
    (answer $method:ident $(#[$doc:meta])* $name:ident($($id:ident),*) [$($step:expr),+] $body:ty, $answer:ty) => {
        $(#[$doc])*
        pub async fn $name(
            &self,
            $($id: &str,)*
            body: &impl $crate::Body<$body>,
        ) -> Result<$answer, $crate::ClientError> {
            Ok(self.write(reqwest::Method::$method, &[$($step),+], &[], body).await?.answer)
        }
    };
    (remove $(#[$doc:meta])* $name:ident($($id:ident),*) [$($step:expr),+]) => {
        $(#[$doc])*
        pub async fn $name(&self, $($id: &str),*) -> Result<(), $crate::ClientError> {
            self.ask(reqwest::Method::DELETE, &[$($step),+], &[]).await.map(drop)
        }
    };
    (remove $($row:tt)+) => { $crate::operation::operation! { ask DELETE $($row)+ } };
}

pub(super) use {operation, operations};

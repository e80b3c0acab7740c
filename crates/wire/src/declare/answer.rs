//! Objects that are answered, each field with what it is filled from.

/// Declares an object of an answer, and makes it `of` what there is: each field has its type, a sentence, and what it is filled from. One
/// with a question mark is absent where there is nothing to tell. It can be read back.
#[macro_export]
macro_rules! answer {
    (
        @next [$($derive:path),*] $head:tt [$($known:tt)*]
        $(#[$about:meta])* $field:ident?: $kind:ty = $source:expr, $($rest:tt)*
    ) => {
        $crate::answer! {
            @next [$($derive),*] $head
            [
                $($known)*
                $(#[$about])*
                #[serde(default, skip_serializing_if = "Option::is_none")]
                $field: Option<$kind> = $source,
            ]
            $($rest)*
        }
    };

    (
        @next [$($derive:path),*] $head:tt [$($known:tt)*]
        $(#[$about:meta])* $field:ident: $kind:ty = $source:expr, $($rest:tt)*
    ) => {
        $crate::answer! {
            @next [$($derive),*] $head [$($known)* $(#[$about])* $field: $kind = $source,] $($rest)*
        }
    };

    (
        @next [$($derive:path),*]
        [
            $(#[$about:meta])*
            $visibility:vis struct $Document:ident $(<$lifetime:lifetime>)? as $name:ident $(, $title:literal)?
            of $given:tt { $($before:tt)* }
        ]
        [$($(#[$sentence:meta])* $field:ident: $kind:ty = $source:expr,)*]
    ) => {
        $(#[$about])*
        #[derive($($derive),*)]
        #[schema(as = $name $(, title = $title)?)]
        $visibility struct $Document $(<$lifetime>)? {
            $($(#[$sentence])* $visibility $field: $kind,)*
        }

        impl $(<$lifetime>)? $Document $(<$lifetime>)? {
            /// Tells what there is.
            $visibility fn of $given -> Self {
                $($before)*
                Self { $($field: $source,)* }
            }
        }
    };

    (
        @derive [$($derive:path),*]
        $(#[$about:meta])*
        $visibility:vis struct $Document:ident $(<$lifetime:lifetime>)? as $name:ident $(, $title:literal)?
        of $given:tt $(with { $($before:tt)* })? { $($fields:tt)* }
    ) => {
        $crate::answer! {
            @next [$($derive),*]
            [
                $(#[$about])*
                $visibility struct $Document $(<$lifetime>)? as $name $(, $title)?
                of $given { $($($before)*)? }
            ]
            [] $($fields)*
        }
    };

    ($(#[$about:meta])* $visibility:vis struct $($declared:tt)*) => {
        $crate::answer! {
            @derive [Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize, utoipa::ToSchema]
            $(#[$about])* $visibility struct $($declared)*
        }
    };
}

/// The same of an object that is only written.
#[macro_export]
macro_rules! view {
    ($(#[$about:meta])* $visibility:vis struct $($declared:tt)*) => {
        $crate::answer! {
            @derive [serde::Serialize, utoipa::ToSchema]
            $(#[$about])* $visibility struct $($declared)*
        }
    };
}

pub(crate) use {answer, view};

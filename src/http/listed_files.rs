//! Files of which one handler answers several, as the OpenAPI document lists them.

/// A file among those that one handler answers.
pub(super) struct ListedFile {
    /// Its name.
    pub(super) name: &'static str,
    /// Its media type.
    pub(super) media_type: &'static str,
    /// The name of the schema of the file, or of each of its lines, where there is one.
    pub(super) schema: Option<&'static str>,
    /// What it holds; absent where the words for all files say enough.
    pub(super) about: Option<&'static str>,
    /// The parameters of the handler that it does not take.
    pub(super) without: &'static [&'static str],
}

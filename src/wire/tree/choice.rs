//! Fields that take one of a few words.

/// Words that a field may take, each standing for a value.
pub(in crate::wire) trait Choice: Copy + PartialEq + 'static {
    /// Word, value, and what it means.
    const OPTIONS: &'static [(&'static str, Self, &'static str)];

    /// The word for this value.
    fn word(self) -> &'static str {
        Self::OPTIONS
            .iter()
            .find(|(_, value, _)| *value == self)
            .map_or("", |(word, ..)| word)
    }

    /// The value that `word` stands for.
    fn of_word(word: &str) -> Option<Self> {
        Self::OPTIONS
            .iter()
            .find(|(option, ..)| *option == word)
            .map(|(_, value, _)| *value)
    }

    /// All words, for a sentence.
    fn words() -> String {
        Self::OPTIONS
            .iter()
            .map(|(word, ..)| *word)
            .collect::<Vec<_>>()
            .join(", ")
    }
}

/// Writes a choice as its word.
pub(in crate::wire) fn as_word<C: Choice, S: serde::Serializer>(
    choice: &C,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(choice.word())
}

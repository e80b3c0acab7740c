//! Outlines of the tables that are being read, each made once for all who read it.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, Weak};

use meshwright_studies::table::KnownQuantities;
use tokio::sync::OnceCell;
use uuid::Uuid;

/// Values of all rows that the first one needs.
pub(super) struct Front {
    pub(super) pointers: Vec<String>,
    pub(super) quantities: KnownQuantities,
    /// True for each row that no other row beats.
    pub(super) best: Vec<bool>,
}

/// The outlines of tables that are being read, by study and version.
#[derive(Clone, Default)]
pub struct Outlines(Arc<Mutex<HashMap<StudyVersion, Weak<OnceCell<Front>>>>>);

type StudyVersion = (Uuid, i64);

impl Outlines {
    /// The place for the outline of a study, which is there as long as somebody has it.
    pub(super) fn of(&self, study: StudyVersion) -> Arc<OnceCell<Front>> {
        let mut known = self.0.lock().expect("nothing panics with this lock");
        known.retain(|_, front| front.strong_count() > 0);
        let place = known.entry(study).or_default();
        let cell = place.upgrade().unwrap_or_default();
        *place = Arc::downgrade(&cell);
        cell
    }
}

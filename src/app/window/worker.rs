//! Work that a worker of the web page can do.

use crate::app::modes::learn::ElementErrors;
use crate::app::platform;
use crate::app::session::facts::{
    CurveFact, FrequencyFact, LimitsFact, MotionTimeFact, PathFact, ReferenceFact, RhoFact, StudyFact, TimeFact,
};
use crate::app::task::keyed::FactWork;
use crate::app::task::thread::{Work, serve};

/// Work by its name.
type WorkerEntry = (&'static str, fn(&[u8]));

const fn entry<W: Work>() -> WorkerEntry {
    (W::NAME, serve::<W>)
}

const ENTRIES: &[WorkerEntry] = &[
    entry::<FactWork<ReferenceFact>>(),
    entry::<FactWork<CurveFact>>(),
    entry::<FactWork<LimitsFact>>(),
    entry::<FactWork<PathFact>>(),
    entry::<FactWork<TimeFact>>(),
    entry::<FactWork<MotionTimeFact>>(),
    entry::<FactWork<FrequencyFact>>(),
    entry::<FactWork<RhoFact>>(),
    entry::<FactWork<ElementErrors>>(),
    entry::<FactWork<StudyFact>>(),
];

/// Waits for requests of the page.
pub(super) fn listen() {
    platform::work::listen(|name, request| {
        if let Some((_, serve)) = ENTRIES.iter().find(|(own, _)| *own == name) {
            serve(request);
        }
    });
}

//! Work that a worker of the web page can do.

use crate::app::platform;
use crate::app::session::facts::{
    CostFact, CurveFact, LimitsFact, PathFact, ReferenceFact, RhoFact, StudyFact, TimeFact,
};
use crate::app::task::keyed::{Fact, work};
use crate::app::task::thread::serve;

/// Work by its name.
type WorkerEntry = (&'static str, fn(&[u8]));

const fn entry<F: Fact>() -> WorkerEntry {
    (F::NAME, |request| serve(request, work::<F>))
}

const ENTRIES: &[WorkerEntry] = &[
    entry::<ReferenceFact>(),
    entry::<CurveFact>(),
    entry::<LimitsFact>(),
    entry::<PathFact>(),
    entry::<TimeFact>(),
    entry::<CostFact>(),
    entry::<RhoFact>(),
    entry::<StudyFact>(),
];

/// Waits for requests of the page.
pub(super) fn listen() {
    platform::work::listen(|name, request| {
        if let Some((_, serve)) = ENTRIES.iter().find(|(own, _)| *own == name) {
            serve(request);
        }
    });
}

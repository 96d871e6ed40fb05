//! Start of the graphics device.

/// Runs `opening` to its end.
pub(crate) fn open(opening: impl Future<Output = ()> + 'static) {
    pollster::block_on(opening);
}

//! The runtime of a command.

use anyhow::Context;
use tokio::runtime::{Builder, Runtime};

/// Bytes of the stack of a thread. Futures that are not optimized take more than the usual 2 MB; memory is only taken where it is touched.
const STACK: usize = 16 << 20;

/// Starts the runtime.
///
/// # Errors
///
/// If the system gives no threads.
pub(crate) fn runtime() -> anyhow::Result<Runtime> {
    let runtime = Builder::new_multi_thread()
        .enable_all()
        .thread_stack_size(STACK)
        .build();
    runtime.context("the runtime cannot be started")
}

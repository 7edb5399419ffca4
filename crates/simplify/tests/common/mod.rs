//! Helpers shared by the test suites of this crate.

use meshlod_simplify::Method;

/// The methods that the kernel runs.
pub fn kernel_methods() -> impl Iterator<Item = Method> {
    Method::ALL.into_iter().filter(|method| method.runs_in_kernel())
}

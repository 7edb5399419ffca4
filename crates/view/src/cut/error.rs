//! Errors of following a query.

use meshlod::multires::QueryError;
use thiserror::Error;

/// Reason why a follower has no answer.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum CutError {
    /// The query is invalid; the cut has not changed.
    #[error(transparent)]
    Query(#[from] QueryError),
    /// The thread has ended, which it never does by itself.
    #[error("the thread that follows the cut has ended")]
    Ended,
}

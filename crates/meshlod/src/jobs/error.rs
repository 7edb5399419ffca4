//! Why a job was not done.

use std::error::Error;
use std::fmt::Display;

use thiserror::Error;

/// Reason why a job was not done, in one line, by the part of it that is at fault.
///
/// Programs put the name of that part before the reason: the option, the file that was read, or the
/// file to be written. The typed error, if there is one, is the [`source`](Error::source).
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum JobError {
    /// A field of the request has no meaning, or does not go with another one.
    #[error("{reason}")]
    Request {
        /// Name of the field; empty if the reason names the fields itself.
        field: &'static str,
        /// Reason, without the name of the field.
        reason: String,
    },
    /// The input of the job cannot be used.
    #[error("{0}")]
    Input(#[source] Box<dyn Error + Send + Sync>),
    /// The second of two things that the job works on cannot be used.
    #[error("{0}")]
    Second(#[source] Box<dyn Error + Send + Sync>),
    /// The result cannot be made or stored in the form that was asked for.
    #[error("{0}")]
    Output(#[source] Box<dyn Error + Send + Sync>),
    /// The watch has cancelled the job.
    #[error("cancelled")]
    Cancelled,
}

impl JobError {
    /// Creates the error of a field of a request.
    pub fn request(field: &'static str, reason: impl Display) -> Self {
        Self::Request { field, reason: reason.to_string() }
    }

    /// Creates the error of what a job works on.
    pub fn input(error: impl Into<Box<dyn Error + Send + Sync>>) -> Self {
        Self::Input(error.into())
    }

    /// Creates the error of the second of two things that a job works on.
    pub fn second(error: impl Into<Box<dyn Error + Send + Sync>>) -> Self {
        Self::Second(error.into())
    }

    /// Creates the error of what a job returns.
    pub fn output(error: impl Into<Box<dyn Error + Send + Sync>>) -> Self {
        Self::Output(error.into())
    }
}

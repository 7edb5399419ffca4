//! Options of the method that simplifies, for the verbs that make levels.

use clap::Args;
use meshlod::Method;
use meshlod::simplify::AttributeWeights;

use crate::options::constraints::ConstraintArgs;
use crate::options::parse;

/// Method and its options.
#[derive(Args)]
#[command(next_help_heading = "Method")]
pub struct MethodArgs {
    #[arg(long, value_name = "NAME", default_value = Method::default().name(),
        help = parse::methods())]
    pub method: Method,
    /// Cost weight of boundaries, where 0 means none [default: 9 for lindstrom-turk, 2 for qem]
    #[arg(long, value_name = "WEIGHT", value_parser = parse::weight, allow_negative_numbers = true)]
    pub boundary: Option<f64>,
    #[command(flatten)]
    pub constraints: ConstraintArgs,
    #[command(flatten)]
    weights: WeightArgs,
}

const WEIGHTS: AttributeWeights = AttributeWeights::DEFAULT;

/// Weights of attributes in the cost of a contraction.
#[derive(Args)]
#[command(next_help_heading = "Attributes")]
struct WeightArgs {
    /// Weight of normals in the cost, 0 for none
    ///
    /// A deviation of 1 counts like this fraction of the diagonal. For lindstrom-turk, qem and
    /// qem-endpoint.
    #[arg(long, value_name = "W", default_value_t = WEIGHTS.normal, value_parser = parse::weight,
        allow_negative_numbers = true)]
    weight_normal: f64,
    /// Weight of texture coordinates in the cost, 0 for none
    ///
    /// A texture that slides by a length counts like this fraction of it. For lindstrom-turk, qem
    /// and qem-endpoint.
    #[arg(long, value_name = "W", default_value_t = WEIGHTS.uv, value_parser = parse::weight,
        allow_negative_numbers = true)]
    weight_uv: f64,
    /// Weight of colours in the cost, 0 for none
    ///
    /// A deviation of 1 counts like this fraction of the diagonal. For lindstrom-turk, qem and
    /// qem-endpoint.
    #[arg(long, value_name = "W", default_value_t = WEIGHTS.color, value_parser = parse::weight,
        allow_negative_numbers = true)]
    weight_color: f64,
}

impl MethodArgs {
    /// Returns the weights of attributes.
    pub fn weights(&self) -> AttributeWeights {
        let WeightArgs { weight_normal, weight_uv, weight_color } = self.weights;
        AttributeWeights { normal: weight_normal, uv: weight_uv, color: weight_color }
    }
}

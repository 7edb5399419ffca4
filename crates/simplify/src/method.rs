//! The table of simplification methods: one row holds all facts about one.

/// Mesh simplification algorithm.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Method {
    /// Edge contraction by quadric error metrics, with optimal placement of new vertices [GH97].
    Qem,
    /// Quadric error metrics with half-edge contraction: every vertex of the result is a vertex of
    /// the input [GH97].
    QemEndpoint,
    /// Quadric error metrics as first published [GH97]: planes of equal weight, nothing forgotten,
    /// attributes not counted. A yardstick for comparisons.
    QemPlain,
    /// Memoryless simplification: edge contraction by swept volume, conserving the volume [LT98].
    #[default]
    LindstromTurk,
    /// Memoryless simplification by face contraction, conserving the volume [LT98].
    LindstromTurkFaces,
    /// Face constriction (contraction of whole faces) that conserves the volume [LJ05].
    LeeJang,
    /// Face constriction (contraction of whole faces) to the weighted mean of the corners [Wu01].
    Wu,
    /// Edge contraction ordered by quadrics, with positions moved to conserve the volume [KJ04].
    KimJang,
    /// Progressive meshes: edge contraction that minimizes the squared distances of surface samples
    /// [Hop96].
    Pm,
    /// Simple polygon reduction: edge contraction onto input vertices, ordered by edge length times
    /// turning angle [Mel98].
    Spr,
}

/// Number of methods.
const COUNT: usize = 10;

/// The facts about every method, in the order of the variants.
#[rustfmt::skip]
const TABLE: [MethodFacts; COUNT] = {
    use CostUnit::*;
    use Method::*;
    use MethodTrait::*;
    [
        row(Qem, "qem", WeightedSquaredDistance, &[RunsInKernel, CountsAttributes, WeighsBoundaries]),
        row(QemEndpoint, "qem-endpoint", WeightedSquaredDistance, &[CountsAttributes, WeighsBoundaries]),
        row(QemPlain, "qem-plain", SquaredDistance, &[WeighsBoundaries]),
        row(LindstromTurk, "lindstrom-turk", SquaredVolumePerLength,
            &[RunsInKernel, CountsAttributes, WeighsBoundaries, ConservesVolume]),
        row(LindstromTurkFaces, "lindstrom-turk-faces", SquaredVolume, &[WeighsBoundaries, ConservesVolume]),
        row(LeeJang, "lee-jang", Distance, &[ConservesVolume]),
        row(Wu, "wu", Distance, &[]),
        row(KimJang, "kim-jang", WeightedSquaredDistance, &[WeighsBoundaries, ConservesVolume]),
        row(Pm, "pm", SampledSquaredDistance, &[]),
        row(Spr, "spr", Distance, &[]),
    ]
};

/// Unit of the costs of a method's contractions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum CostUnit {
    /// A distance.
    Distance,
    /// A squared distance.
    SquaredDistance,
    /// A sum of squared distances over samples, about one per face.
    SampledSquaredDistance,
    /// A squared distance times an area.
    WeightedSquaredDistance,
    /// A squared volume divided by the root of an area.
    SquaredVolumePerLength,
    /// A squared volume.
    SquaredVolume,
}

impl CostUnit {
    /// Returns the power of length in the unit.
    const fn power(self) -> i32 {
        match self {
            Self::Distance => 1,
            Self::SquaredDistance | Self::SampledSquaredDistance => 2,
            Self::WeightedSquaredDistance => 4,
            Self::SquaredVolumePerLength => 5,
            Self::SquaredVolume => 6,
        }
    }
}

/// Property that some methods have.
#[derive(Clone, Copy)]
enum MethodTrait {
    RunsInKernel,
    CountsAttributes,
    WeighsBoundaries,
    ConservesVolume,
}

/// Row of the table of methods.
struct MethodFacts {
    method: Method,
    name: &'static str,
    cost_unit: CostUnit,
    runs_in_kernel: bool,
    counts_attributes: bool,
    weighs_boundaries: bool,
    conserves_volume: bool,
}

const fn row(
    method: Method,
    name: &'static str,
    cost_unit: CostUnit,
    traits: &[MethodTrait],
) -> MethodFacts {
    let mut facts = MethodFacts {
        method,
        name,
        cost_unit,
        runs_in_kernel: false,
        counts_attributes: false,
        weighs_boundaries: false,
        conserves_volume: false,
    };
    let mut i = 0;
    while i < traits.len() {
        match traits[i] {
            MethodTrait::RunsInKernel => facts.runs_in_kernel = true,
            MethodTrait::CountsAttributes => facts.counts_attributes = true,
            MethodTrait::WeighsBoundaries => facts.weighs_boundaries = true,
            MethodTrait::ConservesVolume => facts.conserves_volume = true,
        }
        i += 1;
    }
    facts
}

impl Method {
    /// All simplification methods, in a fixed order.
    pub const ALL: [Self; COUNT] = {
        let mut all = [Self::Qem; COUNT];
        let mut i = 0;
        while i < COUNT {
            all[i] = TABLE[i].method;
            assert!(all[i] as usize == i, "the table has the order of the variants");
            i += 1;
        }
        all
    };

    #[inline]
    const fn facts(self) -> &'static MethodFacts {
        &TABLE[self as usize]
    }

    /// Returns the name of the method on the command line and in reports.
    pub fn name(self) -> &'static str {
        self.facts().name
    }

    /// Returns the power of length in the unit of the method's costs: 2 for squared distances, 6
    /// for squared volumes.
    ///
    /// Quadrics give squared distances times areas, in [`Method::QemPlain`] without areas. Swept
    /// volumes give squared volumes, which [`Method::LindstromTurk`] divides by the root of an area.
    /// Samples give squared distances.
    #[inline]
    pub fn cost_power(self) -> i32 {
        self.cost_unit().power()
    }

    #[inline]
    pub(crate) fn cost_unit(self) -> CostUnit {
        self.facts().cost_unit
    }

    /// Returns true if the kernel runs the method, in single precision, and false if the policy
    /// engine does.
    ///
    /// The kernel checks [`Target::Error`](crate::Target::Error) against the input itself and can
    /// take contractions back.
    #[inline]
    pub fn runs_in_kernel(self) -> bool {
        self.facts().runs_in_kernel
    }

    /// Returns true if attribute errors count in the method's costs, weighted by
    /// [`Options::weights`](crate::Options::weights). Every method keeps attributes in the result.
    pub fn counts_attributes(self) -> bool {
        self.facts().counts_attributes
    }

    /// Returns true if the movement of boundaries counts in the method's costs, weighted by
    /// [`Options::boundary_weight`](crate::Options::boundary_weight).
    pub fn weighs_boundaries(self) -> bool {
        self.facts().weighs_boundaries
    }

    /// Returns true if the method places new vertices so as to conserve the volume, wherever the
    /// ring of faces is closed and no lock or tie fixes the position. [`Method::LindstromTurk`]
    /// leaves a debt to the next contraction where the position would be too far away; see
    /// [`Simplifier::settled_level`](crate::Simplifier::settled_level).
    #[inline]
    pub fn conserves_volume(self) -> bool {
        self.facts().conserves_volume
    }
}

meshlod_mesh::by_name!(Method, "methods");

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_of_the_variants_in_kebab_case() {
        for method in Method::ALL {
            let mut kebab = String::new();
            for c in format!("{method:?}").chars() {
                if c.is_uppercase() && !kebab.is_empty() {
                    kebab.push('-');
                }
                kebab.extend(c.to_lowercase());
            }
            assert_eq!(method.name(), kebab);
        }
    }

    #[test]
    fn the_kernel_runs_the_methods_that_have_a_metric() {
        let of_kernel: Vec<_> = Method::ALL.into_iter().filter(|m| m.runs_in_kernel()).collect();
        assert_eq!(of_kernel, [Method::Qem, Method::LindstromTurk]);
    }
}

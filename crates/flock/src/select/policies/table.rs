//! Entries of the table of policies.

/// Setting that makes a policy coarser or finer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bias {
    /// No setting: the policy always does the same.
    Nothing,
    /// [`Budget::detail`](crate::select::Budget::detail).
    Detail,
    /// [`Budget::triangles`](crate::select::Budget::triangles), which the policy keeps to.
    Triangles,
}

/// Makes `PolicyName` of the policies, one row each: the variant with its documentation, the name
/// on the command line and in files, the title for people, the key in the viewer, the setting that
/// biases it, and a function that makes it for a `&LevelTable`.
macro_rules! policies {
    ($(
        $(#[$doc:meta])*
        $variant:ident = $name:literal, $title:literal, $key:literal, $bias:expr, $make:expr;
    )*) => {
        /// Policy of this crate by its name.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
        pub enum PolicyName {
            $($(#[$doc])* #[serde(rename = $name)] $variant,)*
        }

        impl PolicyName {
            /// All policies in a fixed order.
            pub const ALL: [Self; [$($name),*].len()] = [$(Self::$variant),*];

            /// Returns the name as on the command line.
            pub fn name(self) -> &'static str {
                match self { $(Self::$variant => $name,)* }
            }

            /// Returns the name as people write it.
            pub fn title(self) -> &'static str {
                match self { $(Self::$variant => $title,)* }
            }

            /// Returns the character of the key that chooses the policy in the viewer.
            pub fn key(self) -> char {
                match self { $(Self::$variant => $key,)* }
            }

            /// Returns the setting that makes the policy coarser or finer.
            pub fn bias(self) -> Bias {
                match self { $(Self::$variant => $bias,)* }
            }

            /// Returns true if the policy keeps to
            /// [`Budget::triangles`](crate::select::Budget::triangles).
            pub fn has_budget(self) -> bool {
                self.bias() == Bias::Triangles
            }

            /// Creates the policy for a table of levels.
            pub fn policy(
                self,
                table: &crate::levels::LevelTable,
            ) -> Box<dyn crate::select::Policy> {
                match self { $(Self::$variant => Box::new(($make)(table)),)* }
            }
        }

        meshlod_mesh::by_name!(PolicyName, "policies");
    };
}

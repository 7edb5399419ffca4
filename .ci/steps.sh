# What .ci/run and .ci/nightly share: steps with their seconds, and the programs that steps need.
# The caller is in the project's root.

# Tests run what is compiled here, and nobody else: speed of the compiler comes first. Nothing is
# optimized across crates or units of code, and hardly anything in the crates of others, the command
# and the viewer, which leave the work to ours. The Python package, a workspace of its own, has the
# same profile so that it shares what it can.
export CARGO_PROFILE_RELEASE_CODEGEN_UNITS=16 CARGO_PROFILE_RELEASE_LTO=off CARGO_PROFILE_DEV_DEBUG=0
quick=(profile.release.package.meshlod-simplify.codegen-units=16
    'profile.release.package."*".opt-level=1'
    profile.release.package.meshlod-cli.opt-level=1
    profile.release.package.meshlod-view.opt-level=1)
release=(--release "${quick[@]/#/--config=}")

# Everything temporary, for scripts that may end anywhere.
work="$(mktemp -d)"
trap 'kill $(jobs -p) 2>/dev/null || true; rm -rf "$work"' EXIT

meshes="${MESHLOD_MESHES:-../shared/meshes}"
budgets="$(dirname "${BASH_SOURCE[0]}")/budgets"
times=target/ci-seconds.txt
mkdir -p target
printf '%-14s %8s %8s\n' step seconds budget >"$times"
step=

# step NAME WHAT: ends the step before and begins the next.
step() {
    end_step
    step="$1"
    step_began=$SECONDS
    printf '\n== %s: %s (after %d s)\n' "$1" "$2" "$SECONDS"
}

# Writes the seconds of a step beside its budget; twice the budget is worth a warning.
end_step() {
    if [ -z "$step" ]; then return; fi
    local took=$((SECONDS - step_began)) budget
    budget="$(awk -v step="$step" '$1 == step { print $2 }' "$budgets")"
    printf '%-14s %8d %8s\n' "$step" "$took" "${budget:--}" >>"$times"
    if [ -n "$budget" ] && [ "$took" -gt $((2 * budget)) ]; then
        echo "warning: $step took $took s; its budget is $budget s" | tee -a "$times"
    fi
    step=
}

# mesh NAME...: prints the paths of those shared meshes that are there, one a line.
mesh() {
    local name
    for name in "$@"; do
        if [ -f "$meshes/$name" ]; then
            echo "$meshes/$name"
        else
            echo "skipped: $name is not there" >&2
        fi
    done
}

# install PACKAGE...: installs packages of Debian, as root.
install() {
    apt-get update -q && apt-get install -yq --no-install-recommends "$@"
}

# need COMMAND PACKAGE...: installs packages where a command is missing.
need() {
    if ! command -v "$1" >/dev/null; then install "${@:2}"; fi
}

# venv FOLDER PIP_ARGUMENT...: makes an environment of Python with packages.
venv() {
    if ! python3 -m venv "$1" >/dev/null 2>&1; then
        install python3-venv
        python3 -m venv "$1"
    fi
    "$1/bin/pip" install -q --disable-pip-version-check "${@:2}"
}

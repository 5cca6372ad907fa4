# Sourced by bench/quickstart, tests/run and .ci/run: installs what is missing and builds a preset.
# Talk goes to stderr. Expects to be in the repository's root.

setup_say() { printf '%s\n' "$*" >&2; }

# True if one of the alternatives a|b|c is installed.
setup_has_package()
{
    local name
    for name in ${1//|/ }; do
        [ "$(dpkg-query -W -f='${db:Status-Status}' "$name" 2>/dev/null)" = installed ] && return 0
    done
    return 1
}

# Prints the packages of the given groups that are not installed, the first alternative of each.
setup_missing_packages()
{
    local group package reason
    while read -r group package reason; do
        [[ " $* " == *" $group "* ]] || continue
        setup_has_package "$package" || printf '%s ' "${package%%|*}"
    done < <(grep -v '^#' bench/packages.txt)
}

# setup_packages GROUP...: installs what is missing, as root or through sudo; fails with the one command to run.
setup_packages()
{
    if ! command -v dpkg-query >/dev/null; then
        setup_say "no dpkg here: bench/packages.txt lists what must be installed; going on"
        return 0
    fi
    local missing as_root=()
    missing=$(setup_missing_packages "$@")
    [ -n "$missing" ] || return 0
    if [ "$(id -u)" -ne 0 ]; then
        if ! sudo -n true 2>/dev/null; then
            setup_say "packages are missing and this user may not install them. Run this, then start again:"
            setup_say "    su -c 'apt-get update && apt-get install -y --no-install-recommends ${missing% }'"
            return 1
        fi
        as_root=(sudo -n)
    fi
    setup_say "installing: $missing"
    setup_apt_install $missing
}

# Installs; refreshes the package lists only if the first try cannot do without. Uses as_root of its caller.
setup_apt_install()
{
    local get=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -y -q)
    "${get[@]}" install --no-install-recommends "$@" </dev/null >&2 && return 0
    setup_say "refreshing the package lists"
    "${get[@]}" update </dev/null >&2 && "${get[@]}" install --no-install-recommends "$@" </dev/null >&2 && return 0
    setup_say "apt-get could not install: $*"
    return 1
}

# setup_build PRESET [TARGET]: configures and builds it, all or one target; Ninja if it is there, else make.
setup_build()
{
    local preset=$1 target=${2:-all} generator=()
    command -v ninja >/dev/null || generator=(-G "Unix Makefiles")
    cmake --preset "$preset" "${generator[@]}" </dev/null >&2 &&
        cmake --build --preset "$preset" --target "$target" -j "$(nproc)" </dev/null >&2
}

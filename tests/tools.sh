# Sourced by the checks that need more than Rust and a C compiler: what they need is installed where that may be done.

packages=$(dirname "${BASH_SOURCE[0]}")/../target/packages.lock

# An installation that hangs is given up.
patience=600

# Whether COMMAND succeeds, once PACKAGES of the system are installed: provide COMMAND PACKAGE ...
provide() {
    local command=$1 as_root=''
    shift
    $command >/dev/null 2>&1 && return
    command -v apt-get >/dev/null || return 1
    [ "$(id -u)" = 0 ] || as_root='sudo -n'
    say "installing $*."
    # The package system serves one at a time, and checks run side by side.
    mkdir -p "${packages%/*}"
    {
        flock 9
        timeout $patience $as_root apt-get -qq update &&
            timeout $patience $as_root env DEBIAN_FRONTEND=noninteractive apt-get -qq install -y --no-install-recommends "$@"
    } 9>"$packages" >/dev/null 2>&1 </dev/null || true
    $command >/dev/null 2>&1
}

# Whether PROGRAM is in the environment FOLDER of PYTHON (python3), once REQUIREMENTS are installed there: python_tool FOLDER PROGRAM REQUIREMENTS [PYTHON]
python_tool() {
    local python=${4:-python3}
    cmp -s "$3" "$1/requirements.txt" && "$1/bin/$2" --version >/dev/null 2>&1 && return
    provide "$python -m ensurepip --version" $python-venv || return 1
    say "installing $2."
    $python -m venv --clear "$1" >/dev/null 2>&1 &&
        timeout $patience "$1/bin/pip" install --quiet --requirement "$3" >/dev/null 2>&1 </dev/null &&
        cp "$3" "$1/requirements.txt"
}

# Whether PROGRAM is in node_modules of FOLDER, once the packages of PACKAGE_JSON are installed there: npm_tool FOLDER PROGRAM PACKAGE_JSON
npm_tool() {
    cmp -s "$3" "$1/package.json" && "$1/node_modules/.bin/$2" --version >/dev/null 2>&1 && return
    provide 'npm --version' nodejs npm || return 1
    say "installing the packages of $3."
    mkdir -p "$1" && cp "$3" "$1/package.json" &&
        timeout $patience npm install --silent --no-audit --no-fund --prefix "$1" </dev/null &&
        "$1/node_modules/.bin/$2" --version >/dev/null
}

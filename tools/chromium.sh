#!/bin/sh
# Install Debian's headless chromium, which drives the explorer's page in the tests, where there is
# none.  A whole chromium does as well, but starts far more than a page needs.
set -eu

if command -v chromium-headless-shell > /dev/null; then
    exit 0
fi

# Why it is not installed; no error where there is a whole one.
without() {
    echo "tools/chromium.sh: $1" >&2
    if command -v chromium > /dev/null || command -v chromium-browser > /dev/null; then
        exit 0
    fi
    echo "install chromium by hand; without it the tests of the page are skipped" >&2
    exit 1
}

if ! command -v apt-get > /dev/null; then
    without "no apt-get here"
fi

if [ "$(id -u)" -eq 0 ]; then
    as_root=""
elif sudo -n true 2> /dev/null; then
    as_root="sudo -n"
else
    without "neither root nor sudo without a password for: apt-get install chromium-headless-shell"
fi

# fonts: without any, a page has no text
$as_root apt-get update --quiet || without "apt-get update fails"
install() {
    $as_root env DEBIAN_FRONTEND=noninteractive \
        apt-get install --quiet --yes --no-install-recommends "$1" fonts-dejavu-core
}
# older releases have the whole one alone
install chromium-headless-shell || install chromium || without "apt-get install chromium fails"

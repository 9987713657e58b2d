#!/bin/sh
# Install Debian's chromium, which drives the explorer's page in the tests, where there is none.
set -eu

if command -v chromium > /dev/null || command -v chromium-browser > /dev/null; then
    exit 0
fi

by_hand="install chromium with this system's packages; without it the tests of the page are skipped"
if ! command -v apt-get > /dev/null; then
    echo "tools/chromium.sh: no apt-get here; $by_hand" >&2
    exit 1
fi

if [ "$(id -u)" -eq 0 ]; then
    as_root=""
elif sudo -n true 2> /dev/null; then
    as_root="sudo -n"
else
    echo "tools/chromium.sh: neither root nor sudo without a password; as root: apt-get install chromium" >&2
    exit 1
fi

# fonts: without any, a page has no text
$as_root apt-get update --quiet
$as_root env DEBIAN_FRONTEND=noninteractive \
    apt-get install --quiet --yes --no-install-recommends chromium fonts-dejavu-core

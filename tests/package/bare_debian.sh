#!/usr/bin/env bash
# The package must install on a bare Debian 12, run, and leave nothing behind. Usage: bare_debian.sh PACKAGE.
# Needs root, debootstrap and the network. It makes the system in a temporary folder, and prints the time from the
# start of the installation to the end of the first run, which must be below 60 s plus 10 s for the run itself.
set -euo pipefail
package=$(realpath "${1:?the .deb file}")
work=$(mktemp -d)
trap 'rm -rf --one-file-system "$work"' EXIT
system=$work/system

debootstrap --variant=minbase bookworm "$system" >"$work/log" || { tail "$work/log"; exit 1; }
cp /etc/resolv.conf "$system/etc/"
cp "$package" "$system/root/predictor.deb"

# All that is outside /proc, /dev, /sys and /tmp and is neither apt's nor dpkg's own.
list() {
  (cd "$system" && find . -regextype posix-extended \
    -regex './(proc|dev|sys|tmp|var/(lib/(dpkg|apt)|cache|log))' -prune -o -print | sort)
}

# Runs a command in the system, with its own process table and mounts, which end with it.
inside() {
  unshare --mount --pid --fork chroot "$system" /bin/bash -euc \
    'mount -t proc proc /proc; mkdir -p /dev/shm; mount -t tmpfs tmpfs /dev/shm; export DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8 HOME=/root; cd /tmp; '"$1"
}

inside 'apt-get -qq update'
list >"$work/before"
start=$SECONDS
inside 'apt-get -qq install --no-install-recommends /root/predictor.deb >/tmp/log 2>&1 || { cat /tmp/log; exit 1; }'
echo "Installed after $((SECONDS - start)) s."
inside 'predictor --version; predictor check box_9kg; predictor run box_9kg --duration 10 --no-viewer --record /tmp/run.mcap </dev/null; predictor verify --quiet /tmp/run.mcap'
seconds=$((SECONDS - start))
echo "The package was installed and had run after $seconds s."
inside 'apt-get -qq remove --purge --autoremove predictor >/tmp/log 2>&1 || { cat /tmp/log; exit 1; }; ! command -v predictor'
list >"$work/after"
# The loader's cache and root's own configuration belong to other packages.
if comm -13 "$work/before" "$work/after" | grep -v '^./etc/ld.so.cache$'; then
  echo "The package left these files behind."
  exit 1
fi
[ "$seconds" -le 70 ] || { echo "The installation and the first run took longer than allowed."; exit 1; }

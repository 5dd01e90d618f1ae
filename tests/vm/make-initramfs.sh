#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
#
# make-initramfs.sh IMGROOT KREL "OWN_KO..." FILESDIR OUT -- busybox, init and
# the modules, in load order, as an uncompressed newc cpio.
set -eu
img=$1 krel=$2 ko=$3 files=$4 out=$5
d=$(mktemp -d); trap 'rm -rf "$d"' EXIT
mkdir -p "$d/bin" "$d/mod" "$d/proc" "$d/sys" "$d/dev" "$d/m/host" "$d/m/rw" "$d/m/root"
cp "$(command -v busybox)" "$d/bin/busybox"
for a in sh mount insmod mkdir rm cp ln ip mv sleep sync reboot setsid chroot switch_root cat chmod; do ln -s busybox "$d/bin/$a"; done
cp "$files/init" "$files/devices" "$files/systemd-units" "$d/"; chmod 755 "$d/init"
for m in ${VM_MODULES:-virtio_pci 9pnet_virtio 9p overlay virtio_console configfs vcan can-raw sch_tbf kfifo_buf virtio_blk ext4 crc32c_generic}; do
	modprobe -d "$img" -S "$krel" --show-depends "$m" | awk '$1 == "insmod" { print $2 }'
done | awk '!s[$0]++' | while read -r p; do
	strip --strip-debug -o "$d/mod/${p##*/}" "$p"
	echo "${p##*/}" >> "$d/mod/list"
done
for p in $ko; do
	strip --strip-debug -o "$d/mod/${p##*/}" "$p"
	echo "${p##*/}" >> "$d/mod/list"
done
(cd "$d" && find . | LC_ALL=C sort | cpio -o -H newc --quiet -R 0:0) > "$out.tmp"
mv "$out.tmp" "$out"

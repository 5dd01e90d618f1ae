#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
#
# unpack-vmlinux.sh VMLINUZ OUT -- takes the ELF kernel out of an xz bzImage,
# by the offsets its boot header states (Documentation/x86/boot.rst).
set -eu
rd() { od -An -t u$3 -j $(($2)) -N "$3" "$1" | tr -d ' '; }
sects=$(rd "$1" 0x1f1 1)          # setup_sects
off=$(rd "$1" 0x248 4)            # payload_offset, from the protected-mode code
len=$(rd "$1" 0x24c 4)            # payload_length, last 4 bytes are the size
tail -c +$(( (sects + 1) * 512 + off + 1 )) "$1" | head -c $((len - 4)) | xz -dc > "$2.tmp"
readelf -n "$2.tmp" | grep -q 0x00000012   # XEN_ELFNOTE_PHYS32_ENTRY: PVH bootable
mv "$2.tmp" "$2"

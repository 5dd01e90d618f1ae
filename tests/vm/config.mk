# SPDX-License-Identifier: Apache-2.0
# The kernel of the test VM: its ABI's name, and the exact package version.
# Security updates replace them; tests/vm/kernel then takes the newest.
KABI	?= 6.1.0-50
KVER	?= 6.1.176-1

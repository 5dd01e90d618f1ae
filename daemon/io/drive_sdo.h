/* SPDX-License-Identifier: Apache-2.0 */
/*
 * drive_sdo.h - the command bytes of SDO transfers (CiA 301)
 *
 * Private to drive_setup.c, drive_object.c and drive_latch.c.
 */
#ifndef IO_DRIVE_SDO_H
#define IO_DRIVE_SDO_H

enum drive_sdo {
	SDO_UPLOAD	= 0x40,
	SDO_EXPEDITED	= 0x42,
	SDO_SEGMENTED	= 0x40,		/* the answer to an upload of more than
					 * four bytes */
	SDO_UPLOADED	= 0xf2,		/* the bits of an answer that tell these
					 * two apart */
	SDO_STORED	= 0x60,
	SDO_ABORT	= 0x80,
};

#endif /* IO_DRIVE_SDO_H */

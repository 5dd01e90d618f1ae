/* SPDX-License-Identifier: Apache-2.0 */
/*
 * can_msg.h - a CAN frame with its meaning still unread
 *
 * Classic frames with 11-bit identifiers; edmd ignores all other frames.
 * Numbers in the data are little-endian, as in CANopen (CiA 301).
 */
#ifndef CAN_MSG_H
#define CAN_MSG_H

#include <stdint.h>

struct can_msg {
	uint16_t id;
	uint8_t len;			/* 0 ... 8 */
	uint8_t data[8];
};

/* Default identifiers of CiA 301: function code + node. */
#define CAN_NODE_MAX	127

enum can_id {
	CAN_NMT		= 0x000,
	CAN_SYNC	= 0x080,
	CAN_EMCY	= 0x080,	/* + node, 1 ... 127 */
	CAN_TPDO1	= 0x180,
	CAN_RPDO1	= 0x200,
	CAN_TPDO2	= 0x280,
	CAN_RPDO2	= 0x300,
	CAN_RPDO3	= 0x400,
	CAN_SDO_ANSWER	= 0x580,
	CAN_SDO_ASK	= 0x600,
	CAN_HEARTBEAT	= 0x700,
};

static inline uint32_t can_get(const uint8_t *at, int bytes)
{
	uint32_t x = 0;

	for (int i = 0; i < bytes; i++)
		x |= (uint32_t)at[i] << 8 * i;
	return x;
}

static inline void can_put(uint8_t *at, uint32_t x, int bytes)
{
	for (int i = 0; i < bytes; i++)
		at[i] = (uint8_t)(x >> 8 * i);
}

/**
 * can_bits() - the most bits that a frame of @len data bytes takes, with
 * stuffing and the gap to the next frame: 135 for 8 bytes.
 */
static inline uint32_t can_bits(uint32_t len)
{
	return 47 + 8 * len + (34 + 8 * len - 1) / 4;
}

#endif /* CAN_MSG_H */

/* SPDX-License-Identifier: Apache-2.0 */
/*
 * cia402.c - the words of CiA 301 and CiA 402
 */
#include "cia402.h"

#include <ctype.h>
#include <stdlib.h>

bool cia402_has_torque(uint32_t state)
{
	return state == DRIVE_ENABLED || state == DRIVE_QUICK_STOP ||
	       state == DRIVE_FAULT_REACTION;
}

const char *cia402_state_name(uint32_t state)
{
	static const char *const names[DRIVE_NSTATES] = {
		[DRIVE_NOT_READY]	= "not ready to switch on",
		[DRIVE_DISABLED]	= "switch on disabled",
		[DRIVE_READY]		= "ready to switch on",
		[DRIVE_SWITCHED_ON]	= "switched on",
		[DRIVE_ENABLED]		= "operation enabled",
		[DRIVE_QUICK_STOP]	= "quick stop active",
		[DRIVE_FAULT_REACTION]	= "fault reaction active",
		[DRIVE_FAULT]		= "fault",
	};

	return state < DRIVE_NSTATES ? names[state] : "?";
}

const char *cia402_trouble_name(uint32_t trouble)
{
	static const char *const names[DRIVE_NTROUBLES] = {
		[DRIVE_WELL]		= "well",
		[DRIVE_EMERGENCY]	= "reports a fault",
		[DRIVE_FELL_OFF]	= "left operation enabled by itself",
		[DRIVE_FOLLOWING]	= "is too far from its target",
		[DRIVE_MUTE]		= "sends no heartbeat",
		[DRIVE_NO_ANSWER]	= "does not answer to SYNC",
		[DRIVE_STRANGE]		= "reports a statusword that is no state "
					  "of CiA 402",
		[DRIVE_REBOOTED]	= "has restarted",
		[DRIVE_MISCONFIGURED]	= "refuses its configuration",
		[DRIVE_OTHER_MODE]	= "is not in mode 8, cyclic "
					  "synchronous position; or 7, if "
					  "drive_mode = ip",
		[DRIVE_NOT_LED]		= "ignores its target: bit 12 of its "
					  "statusword is 0",
		[DRIVE_POWERLESS]	= "has no power: safe torque off, its "
					  "supply, or its enable input",
		[DRIVE_LIMITED]		= "clips its target: bit 11 of its "
					  "statusword stays 1",
		[DRIVE_TWICE]		= "answers more often than it is "
					  "asked: are there two with its node?",
		[DRIVE_NOT_STARTED]	= "is no longer operational: somebody "
					  "stopped it by NMT",
	};

	return trouble < DRIVE_NTROUBLES ? names[trouble] : "?";
}

const char *cia402_abort_text(uint32_t code)
{
	static const struct {
		uint32_t code;
		const char *text;
	} texts[] = {
		{ 0x05030000, "toggle bit not alternated" },
		{ 0x05040000, "SDO protocol timed out" },
		{ 0x05040001, "command not known" },
		{ 0x05040005, "out of memory" },
		{ 0x06010000, "access not supported" },
		{ 0x06010001, "write only" },
		{ 0x06010002, "read only" },
		{ 0x06020000, "no such object" },
		{ 0x06040041, "object cannot be mapped" },
		{ 0x06040042, "more than a PDO holds" },
		{ 0x06040043, "parameters do not go together" },
		{ 0x06040047, "incompatible inside the device" },
		{ 0x06060000, "hardware error" },
		{ 0x06070010, "wrong length" },
		{ 0x06070012, "too long" },
		{ 0x06070013, "too short" },
		{ 0x06090011, "no such sub-index" },
		{ 0x06090030, "value out of range" },
		{ 0x06090031, "value too high" },
		{ 0x06090032, "value too low" },
		{ 0x06090036, "maximum below minimum" },
		{ 0x060a0023, "resource not available" },
		{ 0x08000000, "general error" },
		{ 0x08000020, "cannot be stored" },
		{ 0x08000021, "cannot be stored: local control" },
		{ 0x08000022, "cannot be stored in this state" },
		{ 0x08000023, "no object dictionary" },
		{ 0x08000024, "no data" },
	};

	for (size_t i = 0; i < sizeof(texts) / sizeof(texts[0]); i++)
		if (texts[i].code == code)
			return texts[i].text;
	return "code of the maker";
}

const char *cia402_phase_name(uint32_t phase)
{
	static const char *const names[] = {
		[DRIVE_SILENT]		= "silent",
		[DRIVE_CONFIGURED_NEXT]	= "is being set up",
		[DRIVE_RUNNING]		= "up",
		[DRIVE_REFUSED]		= "refused",
	};

	return phase <= DRIVE_REFUSED ? names[phase] : "?";
}

const char *cia402_mode_name(int mode)
{
	static const char *const names[] = {
		"none", "profile position", "velocity", "profile velocity",
		"profile torque", "?", "homing", "interpolated position",
		"cyclic synchronous position", "cyclic synchronous velocity",
		"cyclic synchronous torque",
	};

	return mode < 0 ? "mode of the maker" :
	       mode < (int)(sizeof(names) / sizeof(names[0])) ? names[mode] :
	       "?";
}

/* clang-format off */
static const struct {
	uint16_t code;
	const char *text;
} emergencies[] = {
	{ 0x0000, "no error: the one before is over" },
	{ 0x1000, "generic error" },
	{ 0x2000, "current" },
	{ 0x2100, "current, input side" },
	{ 0x2110, "short circuit or earth leakage, input side" },
	{ 0x2120, "earth leakage, input side" },
	{ 0x2130, "short circuit, input side" },
	{ 0x2200, "current inside the device" },
	{ 0x2213, "over-current in the ramp" },
	{ 0x2214, "over-current in the sequence" },
	{ 0x2220, "continuous over-current inside the device" },
	{ 0x2230, "short circuit or earth leakage inside the device" },
	{ 0x2240, "earth leakage inside the device" },
	{ 0x2250, "short circuit inside the device" },
	{ 0x2300, "current, output side" },
	{ 0x2310, "continuous over-current, output side" },
	{ 0x2320, "short circuit or earth leakage, output side" },
	{ 0x2330, "earth leakage, output side" },
	{ 0x2340, "short circuit, output side" },
	{ 0x3000, "voltage" },
	{ 0x3100, "mains voltage" },
	{ 0x3110, "mains over-voltage" },
	{ 0x3120, "mains under-voltage" },
	{ 0x3130, "phase failure" },
	{ 0x3134, "phase sequence" },
	{ 0x3140, "mains frequency" },
	{ 0x3200, "DC link voltage" },
	{ 0x3210, "DC link over-voltage" },
	{ 0x3220, "DC link under-voltage" },
	{ 0x3230, "load error" },
	{ 0x3300, "output voltage" },
	{ 0x3310, "output over-voltage" },
	{ 0x3320, "armature circuit" },
	{ 0x3330, "field circuit" },
	{ 0x4000, "temperature" },
	{ 0x4100, "ambient temperature" },
	{ 0x4110, "ambient temperature too high" },
	{ 0x4120, "ambient temperature too low" },
	{ 0x4130, "temperature of supply air" },
	{ 0x4140, "temperature of outlet air" },
	{ 0x4200, "temperature of the device" },
	{ 0x4210, "device too hot" },
	{ 0x4220, "device too cold" },
	{ 0x4300, "temperature of the drive" },
	{ 0x4310, "drive too hot" },
	{ 0x4320, "drive too cold" },
	{ 0x4400, "temperature of the supply" },
	{ 0x4410, "supply too hot" },
	{ 0x4420, "supply too cold" },
	{ 0x5000, "hardware of the device" },
	{ 0x5100, "supply of the device" },
	{ 0x5110, "low voltage supply" },
	{ 0x5111, "+-15 V supply" },
	{ 0x5112, "24 V supply" },
	{ 0x5113, "5 V supply" },
	{ 0x5120, "supply of the intermediate circuit" },
	{ 0x5200, "control hardware" },
	{ 0x5210, "measuring circuit" },
	{ 0x5220, "computing circuit" },
	{ 0x5300, "operating unit" },
	{ 0x5400, "power section" },
	{ 0x5410, "output stages" },
	{ 0x5420, "chopper" },
	{ 0x5430, "input stages" },
	{ 0x5440, "contacts" },
	{ 0x5450, "fuses" },
	{ 0x5500, "memory" },
	{ 0x5510, "RAM" },
	{ 0x5520, "ROM" },
	{ 0x5530, "EEPROM" },
	{ 0x6000, "software of the device" },
	{ 0x6010, "software reset: watchdog" },
	{ 0x6100, "internal software" },
	{ 0x6200, "user software" },
	{ 0x6300, "data record" },
	{ 0x6310, "parameters lost" },
	{ 0x6320, "wrong parameter" },
	{ 0x7000, "additional modules" },
	{ 0x7100, "power module" },
	{ 0x7110, "brake chopper" },
	{ 0x7111, "brake chopper failed" },
	{ 0x7112, "over-current of the brake chopper" },
	{ 0x7113, "protection of the brake chopper" },
	{ 0x7120, "motor" },
	{ 0x7121, "motor blocked" },
	{ 0x7122, "motor, or its commutation" },
	{ 0x7123, "motor tilted" },
	{ 0x7200, "measuring module" },
	{ 0x7300, "sensor" },
	{ 0x7301, "tacho" },
	{ 0x7302, "tacho, wrong polarity" },
	{ 0x7303, "resolver 1" },
	{ 0x7304, "resolver 2" },
	{ 0x7305, "incremental encoder 1" },
	{ 0x7306, "incremental encoder 2" },
	{ 0x7307, "incremental encoder 3" },
	{ 0x7310, "speed" },
	{ 0x7320, "position" },
	{ 0x7400, "computing module" },
	{ 0x7500, "communication module" },
	{ 0x7510, "serial interface 1" },
	{ 0x7520, "serial interface 2" },
	{ 0x7600, "data storage" },
	{ 0x8000, "monitoring" },
	{ 0x8100, "communication" },
	{ 0x8110, "CAN overrun, frames lost" },
	{ 0x8120, "CAN error passive" },
	{ 0x8130, "life guard or heartbeat of the master" },
	{ 0x8140, "recovered from bus off" },
	{ 0x8150, "two with one CAN identifier" },
	{ 0x8200, "protocol" },
	{ 0x8210, "PDO too short" },
	{ 0x8220, "PDO too long" },
	{ 0x8230, "DAM MPDO not processed" },
	{ 0x8240, "SYNC of another length" },
	{ 0x8250, "RPDO not in time" },
	{ 0x8300, "torque control" },
	{ 0x8311, "excess torque" },
	{ 0x8312, "difficult start" },
	{ 0x8313, "standstill torque" },
	{ 0x8321, "insufficient torque" },
	{ 0x8331, "torque fault" },
	{ 0x8400, "speed control" },
	{ 0x8500, "position control" },
	{ 0x8600, "positioning" },
	{ 0x8611, "following error" },
	{ 0x8612, "reference limit" },
	{ 0x8700, "SYNC not in time" },
	{ 0x8800, "winding control" },
	{ 0x8900, "process data" },
	{ 0x8a00, "control" },
	{ 0x9000, "external error" },
	{ 0xf000, "additional functions" },
	{ 0xf001, "deceleration" },
	{ 0xf002, "sub-synchronous run" },
	{ 0xf003, "stroke operation" },
	{ 0xf004, "control, additional" },
	{ 0xff00, "maker's own" },
};

static const struct cia402_object objects[] = {
	{ 0x1000, 0, false, "device type" },
	{ 0x1001, 0, false, "error register" },
	{ 0x1003, 0, false, "number of errors" },
	{ 0x1003, 1, false, "standard error field" },
	{ 0x1005, 0, false, "COB-ID SYNC" },
	{ 0x1006, 0, false, "communication cycle period" },
	{ 0x1010, 1, false, "store all parameters" },
	{ 0x1010, 3, false, "store application parameters" },
	{ 0x1011, 1, false, "restore all default parameters" },
	{ 0x1016, 1, false, "consumer heartbeat time" },
	{ 0x1017, 0, false, "producer heartbeat time" },
	{ 0x1018, 1, false, "vendor ID" },
	{ 0x1018, 2, false, "product code" },
	{ 0x1018, 3, false, "revision number" },
	{ 0x1018, 4, false, "serial number" },
	{ 0x6007, 0, true, "abort connection option code" },
	{ 0x603f, 0, false, "error code" },
	{ 0x6040, 0, false, "controlword" },
	{ 0x6041, 0, false, "statusword" },
	{ 0x605a, 0, true, "quick stop option code" },
	{ 0x605b, 0, true, "shutdown option code" },
	{ 0x605c, 0, true, "disable operation option code" },
	{ 0x605d, 0, true, "halt option code" },
	{ 0x605e, 0, true, "fault reaction option code" },
	{ 0x6060, 0, true, "modes of operation" },
	{ 0x6061, 0, true, "modes of operation display" },
	{ 0x6062, 0, true, "position demand value" },
	{ 0x6063, 0, true, "position actual internal value" },
	{ 0x6064, 0, true, "position actual value" },
	{ 0x6065, 0, false, "following error window" },
	{ 0x6066, 0, false, "following error time out" },
	{ 0x6067, 0, false, "position window" },
	{ 0x6068, 0, false, "position window time" },
	{ 0x606b, 0, true, "velocity demand value" },
	{ 0x606c, 0, true, "velocity actual value" },
	{ 0x6071, 0, true, "target torque" },
	{ 0x6072, 0, false, "max torque" },
	{ 0x6073, 0, false, "max current" },
	{ 0x6074, 0, true, "torque demand" },
	{ 0x6075, 0, false, "motor rated current" },
	{ 0x6076, 0, false, "motor rated torque" },
	{ 0x6077, 0, true, "torque actual value" },
	{ 0x6078, 0, true, "current actual value" },
	{ 0x6079, 0, false, "DC link circuit voltage" },
	{ 0x607a, 0, true, "target position" },
	{ 0x607b, 1, true, "min position range limit" },
	{ 0x607b, 2, true, "max position range limit" },
	{ 0x607c, 0, true, "home offset" },
	{ 0x607d, 1, true, "min position limit" },
	{ 0x607d, 2, true, "max position limit" },
	{ 0x607e, 0, false, "polarity" },
	{ 0x607f, 0, false, "max profile velocity" },
	{ 0x6080, 0, false, "max motor speed" },
	{ 0x6081, 0, false, "profile velocity" },
	{ 0x6083, 0, false, "profile acceleration" },
	{ 0x6084, 0, false, "profile deceleration" },
	{ 0x6085, 0, false, "quick stop deceleration" },
	{ 0x608f, 1, false, "encoder increments" },
	{ 0x608f, 2, false, "motor revolutions" },
	{ 0x6091, 1, false, "gear motor revolutions" },
	{ 0x6091, 2, false, "gear shaft revolutions" },
	{ 0x6092, 1, false, "feed constant" },
	{ 0x6092, 2, false, "feed constant shaft revolutions" },
	{ 0x6098, 0, true, "homing method" },
	{ 0x6099, 1, false, "homing speed to switch" },
	{ 0x6099, 2, false, "homing speed to zero" },
	{ 0x609a, 0, false, "homing acceleration" },
	{ 0x60b0, 0, true, "position offset" },
	{ 0x60b1, 0, true, "velocity offset" },
	{ 0x60b2, 0, true, "torque offset" },
	{ 0x60b8, 0, false, "touch probe function" },
	{ 0x60b9, 0, false, "touch probe status" },
	{ 0x60ba, 0, true, "touch probe 1 positive edge" },
	{ 0x60bb, 0, true, "touch probe 1 negative edge" },
	{ 0x60bc, 0, true, "touch probe 2 positive edge" },
	{ 0x60bd, 0, true, "touch probe 2 negative edge" },
	{ 0x60c0, 0, true, "interpolation sub mode" },
	{ 0x60c1, 1, true, "interpolation data record" },
	{ 0x60c2, 1, false, "interpolation time period" },
	{ 0x60c2, 2, true, "interpolation time index" },
	{ 0x60f4, 0, true, "following error actual value" },
	{ 0x60fc, 0, true, "position demand internal value" },
	{ 0x60fd, 0, false, "digital inputs" },
	{ 0x60fe, 1, false, "digital outputs" },
	{ 0x60fe, 2, false, "digital outputs mask" },
	{ 0x60ff, 0, true, "target velocity" },
	{ 0x6502, 0, false, "supported drive modes" },
};
/* clang-format on */

#define NOBJECTS	(sizeof(objects) / sizeof(objects[0]))

/* A code that has no row belongs to the group of one that has. */
const char *cia402_emergency_text(uint16_t code)
{
	static const uint16_t groups[] = { 0xffff, 0xfff0, 0xff00, 0xf000 };

	for (size_t g = 0; g < sizeof(groups) / sizeof(groups[0]); g++)
		for (size_t i = 0; i < sizeof(emergencies) /
				       sizeof(emergencies[0]); i++)
			if (emergencies[i].code == (code & groups[g]) &&
			    (code == 0 || emergencies[i].code != 0))
				return emergencies[i].text;
	return "code of the maker";
}

const struct cia402_object *cia402_object_row(size_t i)
{
	return i < NOBJECTS ? &objects[i] : NULL;
}

const struct cia402_object *cia402_object_at(uint16_t index, uint8_t sub)
{
	for (size_t i = 0; i < NOBJECTS; i++)
		if (objects[i].index == index && objects[i].sub == sub)
			return &objects[i];
	return NULL;
}

/* Letters and digits alone are compared. */
static bool is_same_name(const char *a, const char *b)
{
	do {
		while (*a && !isalnum((unsigned char)*a))
			a++;
		while (*b && !isalnum((unsigned char)*b))
			b++;
		if (tolower((unsigned char)*a) != tolower((unsigned char)*b))
			return false;
	} while (*a++ && *b++);
	return true;
}

bool cia402_object_read(const char *text, uint16_t *ret_index,
			uint8_t *ret_sub)
{
	char *end;
	unsigned long index = strtoul(text, &end, 16), sub = 0;

	if (end != text && *end == ':' && isdigit((unsigned char)end[1]))
		sub = strtoul(end + 1, &end, 0);
	if (end != text && *end == '\0' && index <= 0xffff && sub <= 0xff) {
		*ret_index = (uint16_t)index;
		*ret_sub = (uint8_t)sub;
		return true;
	}
	for (size_t i = 0; i < NOBJECTS; i++) {
		if (!is_same_name(text, objects[i].name))
			continue;
		*ret_index = objects[i].index;
		*ret_sub = objects[i].sub;
		return true;
	}
	return false;
}

/* SPDX-License-Identifier: Apache-2.0 */
/*
 * config.h - the machine file: one table of keys
 *
 * Each key has a section, name, unit, default, smallest and largest value and
 * a line of help, in keys_*.c.  Parser, range check, --print-config and
 * docs/config.md come from that table.  A misspelt key, a value out of range
 * or of the wrong kind is refused with its line.
 *
 * Threads: startup only.
 */
#ifndef CONFIG_H
#define CONFIG_H

#include "backends.h"
#include "process.h"
#include "settings.h"

#include "interp/axis.h"
#include "interp/axis_model.h"
#include "interp/diag.h"
#include "interp/errormap.h"
#include "interp/mcode_arg.h"
#include "interp/setting.h"
#include "interp/wire.h"

#include <stdbool.h>
#include <stdio.h>

#define CONFIG_WAY_MAX		128	/* of a way's text, with its NUL */

/* [axis.*] backlash_* */
struct config_backlash {
	double um, mm_s;
};

/* [can402]: drives on a CAN bus; docs/can402.md. */
struct config_can402 {
	char interface[16];
	double bitrate_kbit;
	double node[INTERP_NAXES];	/* 0: the axis has no drive */
	double master_node;
	double heartbeat_ms;
	double missing_max;		/* answers missing in a row */
	double sdo_ms;			/* time that a drive has for an
					 * answer */
	double following_mm;		/* 0: not supervised */
	double following_s;		/* following_mm grows by the speed times
					 * this */
	double resync_mm, resync_mm_s;	/* back to its place when enabled */
	double enable_s;		/* longest time from a start to
					 * motion */
	double gap_id;			/* identifier of its frames; 0: none */
};

/* [plc]; docs/plc.md. */
struct config_plc {
	char interface[16];		/* "none": there is no PLC */
	double node;
	double alive_ms;		/* its toggle must turn at least so
					 * often, or it is lost */
	double cycle_ms;		/* of the frames to it */
	char m_before[96], m_after[96], m_free[96];	/* lists of M codes */
	char m_redo[96], m_stop[96];
	double m_timeout_s;		/* 0: never */
};

/* [generator] interface. */
enum config_interface {
	GENERATOR_AUTO,			/* the simulated one with backend sim,
					 * else none */
	GENERATOR_SIM, GENERATOR_NONE, GENERATOR_LINES, GENERATOR_CAN,
	GENERATOR_MODBUS, GENERATOR_PLC,
	GENERATOR_NINTERFACES
};

/* [generator]; docs/generator.md. */
struct config_generator {
	int interface;			/* enum config_interface */
	char can_interface[16];
	double can_id;			/* of the frame that is sent if no field
					 * has a place of its own; 0: none */
	char field[PROCESS_NFIELDS][CONFIG_WAY_MAX];	/* as
					 * config_way_read() */
	char told[PROCESS_NTOLD][CONFIG_WAY_MAX];	/* "": no such key */
	char fault_words[256];		/* config_fault_text() */
	char by_hand[96];		/* names of fields; "none" */
	double settle_ms, polarity_ms;
	double silent_ms, confirm_s;
	char modbus[128];		/* config_modbus_read() */
	double baud;
	int parity;			/* enum config_parity */
	double unit;			/* the address of the slave */
	double timeout_ms, every_ms;
};

enum config_parity { PARITY_EVEN, PARITY_NONE, PARITY_ODD };

/* [axis.*] brake: who holds the axis while its drive is off. */
enum config_brake {
	BRAKE_UNSAID, BRAKE_FREE, BRAKE_DRIVE, BRAKE_NONE, BRAKE_LINE
};

enum config_drive_mode {
	DRIVE_CSP,			/* 8, cyclic synchronous position */
	DRIVE_IP,			/* 7, interpolated position */
};

struct config_drive {
	double increments, pulses;	/* so many increments of the drive are
					 * so many pulses */
	double encoder_counts, encoder_pulses;	/* of [gpio] encoder_ */
	int brake;			/* enum config_brake */
	int absolute, follow_bit;	/* 1: yes */
	double fault_reaction, connection_lost;	/* 605E, 6007; -1: as it is */
	double window_mm, quick_stop_mm_s2;	/* 6065, 6085; 0: as it is */
	int mode;			/* enum config_drive_mode */
	double home;			/* 6098; 0: none */
	double velocity_unit, acceleration_unit;	/* of 6099 and 609A, in
							 * increments; 0: these
							 * are as they are */
	char identity[64], sdo[160], leave[64], eds[128],
	     inputs[128];
};

/* [contour]: compensation of the contour error. */
struct config_contour {
	char method[64];
	uint32_t line;			/* of method, in the file; 0: none */
	double speed, acceleration, lead_periods;
	double cross_1_s, predicted_1_s, measured_1_s, horizon_s;
	double noise_mm, model_error;	/* of the machine it is tried on */
};

enum sim_electrode { ELECTRODE_FLAT, ELECTRODE_BALL, ELECTRODE_CONE };

/* [sim]: the simulated machine; docs/process-model.md says what each does. */
struct config_sim {
	double seed;			/* whole number */
	double speed;			/* periods that run in each period of
					 * real time */
	int process;			/* enum cycle_process */

	/* The generator. */
	double on_us, off_us, peak_a, open_v, spark_v;
	uint32_t iso;			/* 1: on time begins at the ignition */
	double wait_us;			/* longest ignition delay */
	double open_us;			/* a longer one counts as open */
	double respond_s;		/* time from the request of power to the
					 * sparks */

	/* The gap, for these pulses and clean. */
	double short_gap_mm, best_gap_mm, open_gap_mm;
	double standoff_mm;		/* air before the workpiece */

	/* The electrode. */
	int electrode;			/* enum sim_electrode */
	double area_mm2;		/* frontal area, of the whole */
	double tip_mm;			/* length of the ball or cone */
	double perimeter_mm;		/* 0: round */
	double depth_mm;		/* depth of the cavity at first */
	double side_gap_mm;		/* beside the electrode */
	double wire_mm, height_mm;	/* diameter, work; wire only */

	/* Removal. */
	double removal_mm3_min;		/* at the best gap, clean */
	double crater_peak_power, crater_on_power;
	double wear_ratio;		/* electrode length lost per depth */
	double negative_removal, negative_wear;	/* factors, with a negative
						 * electrode */

	/* Debris, bridges, arcs. */
	double debris_per_mm;		/* debris made per mm eroded, 0..1
					 * scale */
	double debris_settle_s;		/* time constant, undisturbed */
	double debris_gap_mm;		/* gap lost at debris 1 */
	double secondary;		/* share of sparks that hit debris, at
					 * debris 1 */
	double flush_mm;		/* a fast stroke of this height halves
					 * the debris */
	double flush_mm_s;		/* a stroke at this speed carries half
					 * as much out */
	double flush_per_s;		/* driven out by the pump, at depth 0 */
	double bridge_per_s;		/* debris bridges per second at debris
					 * 1 */
	double bridge_mm;		/* mean length of a bridge */
	double bridge_settle_s;		/* it shrinks with this time constant */
	double deion_us;		/* recovery of a channel */
	double arcing_gain;		/* arcs may stay if it is above 1, at
					 * debris 1 */
	double arcing_s;			/* time constant of a hot
						 * place */
	double break_per_j, rethread_s;	/* of the wire */

	/* Sensors and axes. */
	double noise_v;			/* sigma of the gap voltage */
	uint32_t counted;		/* 1: pulses vary as single ones do */
	double lag_s, start_s;		/* of the axes */
	uint32_t loops;			/* 1: they are the models of loop_* */
	double home_off_mm, index_mm;	/* switches; sim_switches.c */
	double measure_pulses;		/* sigma of the scales */

	/* What a probing motion meets: sim_probe.c. */
	uint32_t block;			/* 1: there is a block */
	double block_min_mm[2], block_max_mm[2];	/* X, Y; machine */
	double block_top_mm;		/* Z; it has no bottom */
	double block_turn_deg;		/* about its middle, from X toward Y */
	double block_tilt_deg;		/* its face rises along X */
	double bore_at_mm[2], bore_mm;	/* centre, diameter; 0: none */
	double feeler_mm;		/* diameter of the electrode */
};

/* [kinematics]: the joints from work to tool; interp/kinematics.h. */
struct config_kinematics {
	char chain[160];		/* "none": no G43.4 */
	double tip_mm[3];
	double tolerance_um;
	uint32_t line;			/* of chain in the file; 0: not set */
};

/* [gpio] lines, in the order of their keys; those of an axis are 8 in a row. */
enum config_line {
	LINE_STEP,
	LINE_DIR = LINE_STEP + INTERP_NAXES,
	LINE_SPARK = LINE_DIR + INTERP_NAXES,
	LINE_PUMP,
	LINE_WATCHDOG,
	LINE_ENABLE,
	LINE_BRAKE,
	CONFIG_NOUTPUTS = LINE_BRAKE + INTERP_NAXES,
	LINE_LIMIT = CONFIG_NOUTPUTS,
	LINE_HOME = LINE_LIMIT + INTERP_NAXES,
	LINE_GAP_OPEN = LINE_HOME + INTERP_NAXES,
	LINE_GAP_SPARK,
	LINE_GAP_SHORT,
	LINE_ESTOP,
	LINE_WIRE,
	LINE_DOOR,
	LINE_DIELECTRIC,
	CONFIG_NLINES
};

#define CONFIG_LINE_MAX	32		/* of a line's text, with its NUL */
#define CONFIG_ENCODER_MAX	(2 * CONFIG_LINE_MAX)

/* A line's text, read. */
struct config_line_at {
	bool wired;			/* false: none */
	bool inverted;			/* low is on */
	char chip[CONFIG_LINE_MAX];	/* empty: [gpio] chip */
	unsigned int offset;
};

/* [gpio]: docs/gpio.md */
struct config_gpio {
	char chip[64];			/* name, label or device file */
	int signal;			/* 0 step and direction, 1 quadrature */
	int pull;			/* of inputs: 0 as is, 1 up, 2 down, 3
					 * no */
	double high_cycles, low_cycles;	/* of a step */
	double high_us, low_us, setup_us;	/* at the least */
	double dir_setup_cycles, dir_hold_cycles;
	char adc[64], adc_trigger[64];	/* of industrial I/O; "none" */
	double adc_channel, adc_ratio;	/* V at the gap for a V at the input */
	double edges_per_period;	/* writes by the edge thread in a
					 * period; 1: there is no edge thread */
	double edges_cpu;		/* -1: any */
	double watchdog_us;		/* between two edges */
	char watchdog_by[128], estop_by[128];	/* what does it, if no line
						 * does; "none": nothing */
	char line[CONFIG_NLINES][CONFIG_LINE_MAX];
	double brake_ms;		/* to open, and to close */
	char encoder[INTERP_NAXES][CONFIG_ENCODER_MAX];	/* as
						 * config_encoder_read() */
	double following_mm, following_s;	/* of axes with an encoder */
	double resync_mm, resync_mm_s;
};

/* [panel]: the operator's page; docs/panel.md. */
struct config_panel {
	char address[64];
	double port;			/* whole number */
	char names[256];		/* "none": the address alone */
	char certificate[256], key[256];	/* "none": no TLS */
	char users[256];
	int local_role;			/* 0 viewer, 1 operator, 2 service */
	char assets[256];
};

/* [electrode]: where electrodes are measured. */
struct config_measure {
	uint32_t there;
	double x_mm, y_mm;
	double clear_z_mm, from_z_mm, to_z_mm;
	double reference_z_mm;
};

struct machine_config {
	/* [machine] */
	char name[32];
	double period_us;		/* 0: by backend */
	int backend;			/* enum config_backend */
	int strategy;			/* enum interp_strategy */
	double tolerance_pulses;	/* mu */
	uint32_t perpendicular;		/* 1: mu is square to the path */
	int coupling;			/* enum interp_coupling */
	double fit_um;			/* tolerance to join lines into curves;
					 * 0: none */
	double feed_default_mm_min;	/* feed before the first F; 0: an F is
					 * required */
	uint32_t optional_stop;		/* 1: M1 holds */
	double threeb_unit_um;		/* of lengths in 3B and 4B programs */
	double fourb_offset_um;		/* of the wire, by 4B's D and DD */
	double cpu;			/* core the cycle is pinned to; -1:
					 * none */
	double priority;		/* SCHED_FIFO */
	double overrun_limit;		/* so many missed periods in a row are a
					 * fault; 0: never */
	uint32_t require_home;		/* 1: no start before */

	struct interp_machine axes;	/* [axis.X] ... [axis.V] */
	struct manual_axis manual[INTERP_NAXES];	/* jog_*, home_*
							 * alone */
	int home_dir[INTERP_NAXES];	/* 0 toward -, 1 toward + */
	struct config_backlash backlash[INTERP_NAXES];
	char pitch_map[INTERP_NAXES][128];	/* a file; "none" */
	struct interp_axis_loop loop[INTERP_NAXES];	/* gain 0: not known */
	char maps[128];			/* [geometry] maps: a file; "none" */
	double over_k;			/* temperature over that of the maps */
	double maps_c;			/* that of the maps */
	struct interp_errormap geometry;	/* of pitch_map and maps,
						 * read */
	double start_mm[INTERP_NAXES];	/* where a simulated machine begins */
	double work_offset_mm[INTERP_NC_NWORK][INTERP_NAXES];	/* [work] */

	struct interp_wire wire;	/* [wire] */
	struct interp_setting set;	/* record_ keys of it */
	double offset_mm[INTERP_NOFFSETS];	/* [wire] offset_*_mm */

	struct config_kinematics kinematics;
	struct config_can402 can402;
	struct config_plc plc;
	struct config_generator generator;
	struct config_drive drive[INTERP_NAXES];
	struct cycle_gap_config gap;
	struct cycle_jump_config jump;
	int jump_escape;		/* enum interp_escape_mode */
	struct config_contour contour;
	struct probe_config probe;
	int probe_with;			/* 0: the sensing voltage; 1: what is on
					 * the gap while the sparks are off */
	double corner_um;		/* [speed] corner_um */
	double tolerance_um, rotary_radius_mm;	/* [speed], of its ends */
	int nodes;			/* [speed] nodes: 0 pass, 1 stop */
	struct config_sim sim;
	struct config_gpio gpio;

	char dialect[256];		/* [nc] dialect: a name or a file */
	char tech_table[256];		/* [tech] table; "none": there is
					 * none */
	struct config_measure measure;
	char folder[256];		/* of the machine file; "": here */

	char lcm_url[128];		/* [lcm] url */
	double dds_domain;		/* [dds] domain */
	double dds_hz;
	struct config_panel panel;
	double keep_jobs, keep_days;	/* [jobs]; ended ones */
	char store_dir[256];		/* [jobs] store: SQLite database's
					 * folder */
};

/** config_defaults() - the built-in machine: eight axes, +-200 mm. */
void config_defaults(struct machine_config *c);

/**
 * config_read() - defaults, then the file.
 *
 * Return: 0; -errno if it cannot be opened; -EINVAL with @diag filled.
 */
int config_read(struct machine_config *c, const char *path,
		struct interp_diag *diag);

/**
 * config_jump_fits() - is no axis's travel too short for a jump of @mm?
 * @wanted: what would be accepted, if not.
 */
bool config_jump_fits(const struct machine_config *c, double mm, char *wanted,
		      size_t size);

/** config_period_ns() - the period that is in force. */
int64_t config_period_ns(const struct machine_config *c);

/** config_points_s() - lattice points that the machine makes in a second. */
double config_points_s(const struct machine_config *c);

/** config_gpio_points_s() - that the lines of [gpio] make in a second: a point
 *  takes the time of a pulse, however many axes it moves. */
double config_gpio_points_s(const struct machine_config *c);

/**
 * config_line_read() - `none`, or [!][CHIP:]NUMBER.
 * Return: NULL, or what is wrong with @text.
 */
const char *config_line_read(const char *text, struct config_line_at *ret);

/* An encoder's text, read. */
struct config_encoder_at {
	bool present;			/* false: none */
	bool lines;			/* by two lines, else by a counter */
	struct config_line_at a, b;
	char counter[CONFIG_ENCODER_MAX];	/* as counter0/count0 */
};

/**
 * config_encoder_read() - `none`, two lines, or counterN/countM.
 * Return: what is wrong with it, or NULL.
 */
const char *config_encoder_read(const char *text,
				struct config_encoder_at *ret);

#define CONFIG_WAY_LINES	6	/* for one field */

enum config_way_kind {
	WAY_NONE,
	WAY_OWN,			/* the machine's backend does it */
	WAY_CAN,
	WAY_LINES,
	WAY_REGISTER,			/* of a Modbus slave */
	WAY_PLC,			/* signals of the PLC */
	WAY_DAC,			/* a converter of industrial I/O */
};

#define CONFIG_DEVICE_MAX	40	/* of a converter's name */


/* How one field reaches the generator, or is told by it. */
struct config_way {
	enum config_way_kind kind;
	struct process_delivers gives;
	/* CAN: in the frames with this identifier.  A register: its address in
	 * a request, from 0. */
	uint16_t id;
	bool input;			/* an input register, to be read only */
	bool low_first;			/* of the two of a count of 32 bits */
	uint8_t bit, bits;		/* first bit of 64, or 16; and how
					 * many */
	double scale;			/* of one count; 0: it is a code.  A
					 * converter: of one V or mA */
	double within;			/* told: so far from what was asked it
					 * still is that */
	/* Lines: the first is the lowest bit.  These and a register may have
	 * codes: `code` i is the value of the code i. */
	uint8_t nlines, ncodes;
	struct config_line_at line[CONFIG_WAY_LINES];
	double code[PROCESS_VALUES_MAX];
	/* A converter: out_voltage@id or out_current@id of @device. */
	char device[CONFIG_DEVICE_MAX];
	bool current;
	double zero, most;		/* V or mA: of the value 0, and the
					 * highest one */
};

/**
 * config_way() - how field @field of enum process_id reaches the generator; its
 * text must be one that was checked.  @told: how the generator tells it.
 */
void config_way(const struct machine_config *c, int field, bool told,
		struct config_way *ret);

/* Where a Modbus slave is. */
struct config_modbus_at {
	bool serial;
	char host[128];			/* the address, or the device: a name of
					 * /dev/serial/by-id is long */
	char port[8];
};

/** config_modbus_read() - a device as /dev/ttyUSB0, or ADDRESS:PORT; an IPv6
 *  address in []. Return: what is wrong with it, or NULL. */
const char *config_modbus_read(const char *text, struct config_modbus_at *ret);

#define CONFIG_MODBUS_WANTED	"a serial port of this host, as /dev/ttyUSB0, " \
				"or ADDRESS:PORT in numbers, as " \
				"192.168.1.5:502 or [fd00::5]:502"

/** config_delivers() - what of field @field reaches the generator. */
void config_delivers(const struct machine_config *c, int field,
		     struct process_delivers *ret);

/**
 * config_generator_limits() - can a program ask for something that would be
 * dropped?  Not where nothing sparks, nor of the simulated generator.
 */
bool config_generator_limits(const struct machine_config *c);

/** config_generator_interface() - enum config_interface, never AUTO. */
int config_generator_interface(const struct machine_config *c);

/** config_generator_beside() - is it a device beside the machine's backend? */
bool config_generator_beside(int interface);

/** config_interface_word() - of enum config_interface; NULL: no such one. */
const char *config_interface_word(int interface);

/** config_way_word() - the first word of a way of this kind; "own": the
 *  machine's backend does it. */
const char *config_way_word(enum config_way_kind kind);

/** config_generator_frames() - how many kinds of its frames are on the CAN
 *  interface @name, from it and to it. */
uint32_t config_generator_frames(const struct machine_config *c,
				 const char *name);

/**
 * config_generator_takes() - can all that @t gives be delivered?
 * Return: 0, or -EINVAL with found and wanted of @diag filled; @who is named in
 * them.
 */
int config_generator_takes(const struct machine_config *c,
			   const struct interp_tech *t, const char *who,
			   struct interp_diag *diag);

#define CONFIG_FAULT_MAX	64

/** config_fault_text() - what a generator tells as its own fault in words, by
 *  @words of [generator] fault_words, as "3 no water", or only its number; ""
 *  for none, and for NAN.  Return: @buf. */
const char *config_fault_text(const char *words, double fault, char *buf,
			      size_t size);

/** config_line_name() - its key: "step_X", "spark", ... */
const char *config_line_name(int line);

/** config_gpio_has_gap() - are there gap comparators, or a converter? */
bool config_gpio_has_gap(const struct machine_config *c);

/** config_gpio_has_lines() - are there lines of a gap comparator? */
bool config_gpio_has_lines(const struct machine_config *c);

/** config_print() - every key with its value, as a machine file. */
void config_print(const struct machine_config *c, FILE *f);

/** config_document() - docs/config.md. */
void config_document(FILE *f);

/** config_process_name() - "sink" or "wire". */
const char *config_process_name(const struct machine_config *c);

/** config_wire_height_mm() - of the work along the wire; 0: not known, or there
 *  is no wire. */
double config_wire_height_mm(const struct machine_config *c,
			     const struct interp_wire *w);

/** config_wire_lean_deg() - how far the wire leans from upright where the axes
 *  are at @pos_mm; 0 without guides. */
double config_wire_lean_deg(const struct machine_config *c,
			    const double pos_mm[INTERP_NAXES]);

/** config_has_plc() - is there a PLC? */
bool config_has_plc(const struct machine_config *c);

/** config_mcodes() - the M codes that the PLC carries out. */
void config_mcodes(const struct machine_config *c,
		   struct interp_mcode table[INTERP_NMCODES]);

struct interp_compensate_gains;
struct contouring_config;

/**
 * config_check_contouring() - can the cycle do what [contour] asks for?
 *
 * The daemon's question: edmsim may try methods that the cycle has not.
 * Return: 0, or -EINVAL with @diag filled.
 */
int config_check_contouring(const struct machine_config *c,
			    struct interp_diag *diag);

/**
 * config_contouring() - [contour] for the cycle; no method if the check refuses
 * it.
 */
void config_contouring(const struct machine_config *c,
		       struct contouring_config *ret);

/**
 * config_loop_true() - what axis @axis may really be like: off by [contour]
 * model_error from what is believed of it.
 *
 * @odd: neighbours are off in the other direction, because an error that all
 * axes share makes no contour error.  Gain and velocity loop are off together,
 * the delay in the opposite direction: so the axis is faster in all, or slower.
 */
struct interp_axis_loop config_loop_true(const struct machine_config *c,
					 int axis, bool odd);

/** config_gains() - the gains of [contour]. */
void config_gains(const struct machine_config *c,
		  struct interp_compensate_gains *ret);

struct cycle_config;

/** config_has_switch() - is axis @axis homed by a switch? */
bool config_has_switch(const struct machine_config *c, int axis);

/**
 * config_cycle() - what the cycle needs of the machine file, in pulses and
 * cycles.
 */
void config_cycle(const struct machine_config *c, struct cycle_config *ret);

#endif /* CONFIG_H */

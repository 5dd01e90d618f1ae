/* SPDX-License-Identifier: Apache-2.0 */
/*
 * status_fields.h - the fields of STATUS, as edm.status_t of messages/edm.lcm
 * has them
 *
 * What fills, sends, receives and prints them is made of this table.  A new
 * field is a row here and in messages/edm.lcm, a line in jobs/status.c, and a
 * line in shm.h and edmd/publish.c if the snapshot does not have it yet.
 *
 * Not in the table: when and from whom, and what is no single number or word
 * (pos_mm, work_mm, faults, contour_mm and contour_predicted_mm).
 *
 * Units: in every name; messages/edm.lcm says what each means.
 */
#ifndef WORDS_STATUS_FIELDS_H
#define WORDS_STATUS_FIELDS_H

#define STATUS_FIELDS(WORD, TEXT, COUNT, NUMBER) \
	WORD(daemon) \
	WORD(state) \
	WORD(fault) \
	WORD(job) \
	WORD(job_name) \
	WORD(job_state) \
	COUNT(line) \
	COUNT(lines) \
	NUMBER(place_mm) \
	NUMBER(length_mm) \
	NUMBER(progress) \
	NUMBER(gap_v) \
	NUMBER(feed_mm_s) \
	NUMBER(depth_mm) \
	NUMBER(depth_far_mm) \
	WORD(process) \
	NUMBER(height_mm) \
	NUMBER(lean_deg) \
	COUNT(jumps) \
	COUNT(retracts) \
	COUNT(shorts) \
	NUMBER(job_s) \
	NUMBER(eta_s) \
	NUMBER(eta_min_s) \
	NUMBER(eta_max_s) \
	WORD(eta_by) \
	WORD(eta_condition) \
	NUMBER(eta_factor) \
	NUMBER(end_s) \
	COUNT(queue_len) \
	NUMBER(queue_s) \
	COUNT(queue_untold) \
	NUMBER(queue_end_s) \
	COUNT(overruns) \
	COUNT(wake_late_max_us) \
	WORD(condition) \
	WORD(store) \
	WORD(interrupted) \
	WORD(lost) \
	WORD(axes) \
	WORD(work) \
	NUMBER(work_turn_deg) \
	COUNT(wire_pass) \
	COUNT(wire_passes) \
	NUMBER(wire_offset_mm) \
	COUNT(hunts) \
	COUNT(electrode) \
	NUMBER(electrode_shift_mm) \
	NUMBER(electrode_wear_mm) \
	WORD(stand) \
	TEXT(asks) \
	NUMBER(stand_s) \
	NUMBER(told_peak_a) \
	NUMBER(told_on_us) \
	NUMBER(told_off_us) \
	NUMBER(told_polarity) \
	NUMBER(told_ignition_v) \
	NUMBER(told_iso) \
	NUMBER(told_servo_v) \
	NUMBER(told_opens) \
	NUMBER(told_sparks) \
	NUMBER(told_arcs) \
	NUMBER(told_shorts) \
	NUMBER(told_energy_j) \
	NUMBER(told_fault) \
	WORD(generator_fault)

#define STATUS_ONE(name)	+ 1

enum { STATUS_NFIELDS = \
	STATUS_FIELDS(STATUS_ONE, STATUS_ONE, STATUS_ONE, STATUS_ONE) };

#endif /* WORDS_STATUS_FIELDS_H */

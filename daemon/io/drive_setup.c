/* SPDX-License-Identifier: Apache-2.0 */
/*
 * drive_setup.c - bring a drive up by SDO
 *
 * The requests are expedited transfers of CiA 301, one at a time.  The drive is
 * pre-operational, because the mapping of PDOs may not change while they are
 * sent.  A request that is not answered is repeated; after SETUP_TRIES the
 * set-up begins again, so that a drive which is switched on later is found.
 *
 * If a write is refused, the object is read: it is good if it has that value
 * already.  So read-only objects are no obstacle.
 */
#include "drive.h"
#include "drive_steps.h"
#include "drive_sdo.h"

#define SETUP_TRIES	3
#define BUSY_TRIES	10		/* of what a busy drive aborts */

#define NMT_START	0x01
#define NMT_QUIET	0x80		/* pre-operational */

/* An expedited transfer that says its size. */
struct can_msg drive_download(const struct drive *d,
			      const struct drive_write *w)
{
	struct can_msg m = { .id = (uint16_t)(CAN_SDO_ASK + d->c.node),
			     .len = 8 };

	m.data[0] = (uint8_t)(0x23 | (4 - w->bytes) << 2);
	can_put(m.data + 1, w->index, 2);
	m.data[3] = w->sub;
	can_put(m.data + 4, w->value, w->bytes);
	return m;
}

struct can_msg drive_upload(const struct drive *d, const struct drive_write *w)
{
	struct can_msg m = { .id = (uint16_t)(CAN_SDO_ASK + d->c.node),
			     .len = 8, .data = { SDO_UPLOAD } };

	can_put(m.data + 1, w->index, 2);
	m.data[3] = w->sub;
	return m;
}

static struct can_msg nmt(const struct drive *d, uint8_t command)
{
	return (struct can_msg) { .id = CAN_NMT, .len = 2,
				  .data = { command, d->c.node } };
}

void drive_setup_again(struct drive *d)
{
	d->phase = DRIVE_SILENT;
	d->step = d->tries = d->choice = 0;
	d->quiet = d->asked = d->reading_back = d->remode = false;
	d->bytes = 0;
	d->unset = false;
	d->shows_mode = false;
	drive_object_drop(d);
	drive_latch_drop(d);
}

/* Time 0: not watched.  Our node stays there, unless the drive loses power. */
size_t drive_setup_end(const struct drive *d, struct can_msg *ret)
{
	const struct drive_write beat = {
		0x1016, 1, 4, (uint32_t)d->c.master << 16, false
	};

	if (d->phase == DRIVE_SILENT)
		return 0;
	ret[0] = drive_download(d, &beat);
	ret[1] = nmt(d, NMT_QUIET);
	return DRIVE_ENDS;
}

static size_t start(struct drive *d, struct can_msg *ret)
{
	d->phase = DRIVE_RUNNING;
	d->busy = 0;
	d->silent = 0;
	d->missing = 0;
	d->alarmed = 0;
	d->lacking = 0;
	d->heard = d->stands = d->has_inputs = false;
	*ret = nmt(d, NMT_START);
	return 1;
}

static size_t ask(struct drive *d, const struct drive_step *s,
		  struct can_msg *ret)
{
	d->asked = true;
	d->waited = 0;
	*ret = s->reads || d->reading_back ? drive_upload(d, &s->write) :
					     drive_download(d, &s->write);
	return 1;
}

size_t drive_setup_emit(struct drive *d, struct can_msg *ret)
{
	struct drive_step s;

	if (d->phase == DRIVE_REFUSED)
		return drive_object_emit(d, ret);
	if (!d->quiet) {
		d->quiet = true;
		*ret = nmt(d, NMT_QUIET);
		return 1;
	}
	if (d->asked && d->waited++ < d->c.answer_cycles)
		return 0;
	if (d->asked && ++d->tries >= SETUP_TRIES) {
		d->unanswered++;
		drive_setup_again(d);
		return 0;
	}
	if (!drive_step_due(d, &s))
		return start(d, ret);
	if (d->asked && drive_step_forgets(&s)) {
		drive_setup_again(d);
		return 0;
	}
	return ask(d, &s, ret);
}

static struct drive_write mode_of(const struct drive *d)
{
	return (struct drive_write) { 0x6060, 0, 1, d->mode_wanted, false };
}

size_t drive_setup_remode(struct drive *d, struct can_msg *ret)
{
	const struct drive_write mode = mode_of(d);

	/* One request at a time: that of a latch first, if it is under way. */
	if (d->latch_sent || (!d->object_step && !d->remode))
		return drive_latch_emit(d, ret);
	if (d->object_step)
		return drive_object_emit(d, ret);
	if (d->asked && d->waited++ < d->c.answer_cycles)
		return 0;
	d->asked = true;
	d->waited = 0;
	*ret = drive_download(d, &mode);
	return 1;
}

/* -- Answers -------------------------------------------------------------- */

void drive_note_abort(struct drive *d, const struct drive_write *w,
		      uint32_t code, enum drive_passed passed)
{
	d->aborts++;
	d->abort = code;
	d->abort_index = w->index;
	d->abort_sub = w->sub;
	d->abort_value = w->value;
	d->passed = passed;
}

static void refuse(struct drive *d)
{
	d->phase = DRIVE_REFUSED;
	if (d->trouble == DRIVE_WELL)
		d->trouble = DRIVE_MISCONFIGURED;
}

static bool is_answer(const struct drive *d, const struct drive_write *w,
		      const struct can_msg *m)
{
	return d->asked && can_get(m->data + 1, 2) == w->index &&
	       m->data[3] == w->sub;
}

uint8_t drive_sdo_bytes(const struct can_msg *m)
{
	return m->data[0] & 1 ? (uint8_t)(4 - (m->data[0] >> 2 & 3)) : 4;
}

static bool is_length(uint32_t code)
{
	return code == 0x06070010 || code == 0x06070012 || code == 0x06070013;
}

/* These codes mean that the object is missing; all others are a refusal. */
static bool is_missing(uint32_t code, const struct drive_step *s)
{
	return code == 0x06020000 || code == 0x06040041 ||
	       (code == 0x06090011 && s->write.sub > 0);
}

/* A drive that has just been switched on may not be ready for all requests. */
bool drive_abort_passes(uint32_t code)
{
	return code == 0x05040000 || code == 0x05040005 ||
	       code == 0x060a0023 || code == 0x08000021 || code == 0x08000022;
}

static void on_abort(struct drive *d, const struct drive_step *s,
		     uint32_t code)
{
	const bool passes = s->write.may_miss && is_missing(code, s);

	if (drive_abort_passes(code) && d->busy < BUSY_TRIES) {
		d->busy++;
		d->asked = true;
		drive_note_abort(d, &s->write, code, DRIVE_LATER);
		return;
	}
	if (d->reading_back) {
		/* It cannot be read either: tell the code of the write. */
		drive_note_abort(d, &s->write, d->refused, DRIVE_NOT_PASSED);
		refuse(d);
		return;
	}
	if (!s->reads && !passes &&
	    (is_length(code) || (!s->kept && !s->has_choice))) {
		d->refused = code;
		d->reading_back = true;
		return;
	}
	drive_note_abort(d, &s->write, code, passes ? DRIVE_WITHOUT :
		   s->kept ? DRIVE_ALREADY :
		   s->has_choice ? DRIVE_ANOTHER : DRIVE_NOT_PASSED);
	if (passes)
		drive_step_missing(d, s);
	else if (s->kept)
		d->step++;
	else if (!s->has_choice || !drive_step_choose(d))
		refuse(d);
}

static uint32_t mask_of(const struct drive_step *s)
{
	return s->write.bytes == 4 ? UINT32_MAX :
	       (1u << 8 * s->write.bytes) - 1;
}

/*
 * It refused a write.  If the object is of another size, the write is repeated
 * with that size; if it has that value already, it will do.
 */
static void on_old_word(struct drive *d, const struct drive_step *s,
			const struct can_msg *m)
{
	const uint8_t bytes = drive_sdo_bytes(m);
	const uint32_t off = can_get(m->data + 4, bytes) ^ s->write.value;
	const bool same = (off & mask_of(s)) == 0;
	const bool sized = is_length(d->refused) && bytes != s->write.bytes;

	d->reading_back = false;
	d->bytes = sized ? bytes : 0;
	d->sized = d->step;
	drive_note_abort(d, &s->write, d->refused, sized ? DRIVE_ANOTHER :
		   same ? DRIVE_ALREADY : DRIVE_NOT_PASSED);
	if (same && !sized)
		d->step++;
	else if (!sized)
		refuse(d);
}

static void on_word(struct drive *d, const struct drive_step *s,
		    const struct can_msg *m)
{
	d->word = can_get(m->data + 4, drive_sdo_bytes(m)) & mask_of(s);
	if (drive_step_finds_restart(d, s)) {
		drive_setup_again(d);
		return;
	}
	if (drive_step_fits(d, s)) {
		d->step++;
		return;
	}
	drive_note_abort(d, &(struct drive_write) {
		s->write.index, s->write.sub, s->write.bytes, d->word, false
	}, 0, s->has_choice ? DRIVE_ANOTHER : DRIVE_NOT_PASSED);
	if (!s->has_choice || !drive_step_choose(d))
		refuse(d);
}

static void hear_remode(struct drive *d, const struct can_msg *m)
{
	const struct drive_write mode = mode_of(d);

	if (!is_answer(d, &mode, m) ||
	    (m->data[0] != SDO_STORED && m->data[0] != SDO_ABORT)) {
		d->malformed++;
		return;
	}
	d->asked = d->remode = false;
	if (m->data[0] != SDO_ABORT)
		return;
	drive_note_abort(d, &mode, can_get(m->data + 4, 4),
		   DRIVE_NOT_PASSED);
	if (d->trouble == DRIVE_WELL)
		d->trouble = DRIVE_OTHER_MODE;
}

void drive_setup_receive(struct drive *d, const struct can_msg *m)
{
	struct drive_step s;
	bool reads;

	if (drive_latch_receive(d, m) || drive_object_receive(d, m))
		return;
	if (d->phase == DRIVE_RUNNING) {
		hear_remode(d, m);
		return;
	}
	if (d->phase > DRIVE_CONFIGURED_NEXT || !drive_step_due(d, &s) ||
	    !is_answer(d, &s.write, m)) {
		d->malformed++;
		return;
	}
	reads = s.reads || d->reading_back;
	if (m->data[0] != SDO_ABORT && (reads ?
	    (m->data[0] & 0xf2) != SDO_EXPEDITED : m->data[0] != SDO_STORED)) {
		d->malformed++;
		return;
	}
	d->phase = DRIVE_CONFIGURED_NEXT;
	d->tries = 0;
	d->asked = false;
	if (m->data[0] == SDO_ABORT)
		on_abort(d, &s, can_get(m->data + 4, 4));
	else if (d->reading_back)
		on_old_word(d, &s, m);
	else if (reads)
		on_word(d, &s, m);
	else
		drive_step_done(d, &s);
}

/* SPDX-License-Identifier: Apache-2.0 */
/*
 * generator_modbus.c - a generator's values in registers of a Modbus slave
 *
 * An exchange takes milliseconds, so a thread of its own makes them.  What the
 * cycle asks for goes to it as records of a version, and each whole exchange
 * comes back as one: the version that the slave has taken, and what it told
 * after that.  An exchange writes only what has changed: some slaves keep their
 * registers in a memory that wears.
 *
 * This is a file of its own because edmsim has no libmodbus.
 */
#include "generator_own.h"
#include "clocks.h"
#include "stamped.h"
#include "thread.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <modbus.h>
#include <semaphore.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#define SLOTS		4		/* a power of two */
#define TRIES		8
#define AGAIN_MS	200		/* between two tries to connect */
#define NONE		UINT32_MAX
#define REGISTERS_MOST	(2 * PROCESS_NTOLD)	/* in a request */

/* What the cycle asks for. */
struct wish {
	_Alignas(uint64_t) uint32_t version;
	uint32_t again;			/* write all of it anew */
	uint32_t given;			/* a bit per field of count */
	uint16_t count[PROCESS_NFIELDS];
};

/* An exchange that was whole, or how one failed. */
struct word {
	_Alignas(uint64_t) uint32_t number;	/* of whole exchanges */
	uint32_t version, again;	/* that the slave has taken; NONE.  The
					 * wish that it answers */
	uint32_t refused;		/* version with a refusal, NONE */
	uint16_t field, exception;	/* ... of it */
	int32_t err;			/* no link: errno; 0: it is there */
	uint32_t count[PROCESS_NTOLD];
};

/* Registers that are written, in the order of their addresses.  Bits that
 * nobody asks for stay as they were read, also those of others. */
struct bank {
	uint16_t address[PROCESS_NFIELDS];
	uint16_t image[PROCESS_NFIELDS];	/* as it is to be, or is */
	bool due[PROCESS_NFIELDS];	/* to be written */
	bool kept[PROCESS_NFIELDS];	/* the slave has this image */
	uint16_t read[PROCESS_NFIELDS];
	bool was_read[PROCESS_NFIELDS];
	int n;
};

struct generator_modbus {
	struct config_modbus_at at;
	struct config_way way[PROCESS_NFIELDS], told[PROCESS_NTOLD];
	int64_t every_ns, settle_ns;
	uint32_t tells;
	bool blind;			/* it does not tell all that it takes */
	/* Between the two. */
	STAMPED_ROW(struct wish, wishes, wish_next, SLOTS);
	STAMPED_ROW(struct word, words, word_next, SLOTS);
	_Atomic bool quit;
	sem_t wake;
	pthread_t thread;
	/* The cycle's. */
	struct wish last;
	uint32_t heard;			/* word.number */
	uint64_t seen;			/* word_next */
	int32_t err;
	/* The thread's. */
	modbus_t *link;
	bool up, singles;		/* singles: it has no function 16 */
	bool met;			/* it was read since the link is up */
	bool odd;			/* it tells another value than it has
					 * taken */
	bool lost;			/* it may have lost what it does not
					 * tell */
	struct bank bank;
	struct word word;
	uint32_t took, again;		/* versions; NONE */
	int64_t took_ns;
};

/* -- The thread: one request ----------------------------------------------- */

static bool is_exception(int err)
{
	return err > MODBUS_ENOBASE && err < EMBBADCRC;
}

/* It is busy, or needs time: that is no refusal. */
static bool is_delay(int err)
{
	return err == EMBXACK || err == EMBXSBUSY;
}

/* It may be switched off meanwhile.  What was in force is not written anew
 * before that is known: there may be sparks. */
static void link_down(struct generator_modbus *m)
{
	modbus_close(m->link);
	m->up = m->met = false;
	if (m->word.version != m->took)
		memset(m->bank.kept, 0, sizeof(m->bank.kept));
	else
		m->lost = m->blind;
	m->word.version = m->lost ? NONE : m->word.version;
}

/* An answer that is late must not be taken for the next one: it has until now
 * to come, and is dropped. */
static void after_failure(struct generator_modbus *m, int err)
{
	const struct timespec pause = { .tv_nsec = 20000000 };

	/* Of libmodbus' own ones: the answer cannot be read. */
	m->word.err = err > MODBUS_ENOBASE ? EBADMSG : err;
	if (err == ECONNRESET || err == EBADF || err == EPIPE || err == EIO ||
	    err == ENXIO || err == ENODEV || !m->at.serial) {
		link_down(m);
		return;
	}
	nanosleep(&pause, NULL);
	modbus_flush(m->link);
}

/* @rc: of a request.  Return: 0; the exception, or -errno. */
static int outcome(struct generator_modbus *m, int rc)
{
	const int err = errno;

	if (rc >= 0)
		return 0;
	if (is_exception(err))
		return err;
	after_failure(m, err);
	return -err;
}

static void refused(struct generator_modbus *m, int field, int err)
{
	m->word.refused = m->took;
	m->word.field = (uint16_t)field;
	m->word.exception = (uint16_t)(err - MODBUS_ENOBASE);
}

/* -- The thread: write ----------------------------------------------------- */

static int field_at(const struct generator_modbus *m, uint16_t address)
{
	int i = 0;

	while (i < PROCESS_NFIELDS - 1 &&
	       (m->way[i].kind != WAY_REGISTER || m->way[i].id != address))
		i++;
	return i;
}

static int bank_find(const struct bank *b, uint16_t address)
{
	int i = 0;

	while (i < b->n && b->address[i] != address)
		i++;
	return i < b->n ? i : -1;
}

static void bank_add(struct bank *b, uint16_t address)
{
	int i = b->n;

	if (bank_find(b, address) >= 0)
		return;
	for (; i > 0 && b->address[i - 1] > address; i--)
		b->address[i] = b->address[i - 1];
	b->address[i] = address;
	b->n++;
}

static unsigned int mask_of(const struct config_way *w)
{
	return ((1u << w->bits) - 1) << w->bit;
}

/* The bits of a register that are asked for, and which these are. */
static unsigned int bits_asked(const struct generator_modbus *m, int at,
			       const struct wish *w, unsigned int *ret_mask)
{
	unsigned int bits = 0;

	*ret_mask = 0;
	for (int i = 0; i < PROCESS_NFIELDS; i++) {
		const struct config_way *y = &m->way[i];

		if (!(w->given >> i & 1) || y->id != m->bank.address[at])
			continue;
		*ret_mask |= mask_of(y);
		bits |= (unsigned int)w->count[i] << y->bit & mask_of(y);
	}
	return bits;
}

static void bank_take(struct generator_modbus *m, const struct wish *w)
{
	struct bank *b = &m->bank;

	for (int i = 0; i < b->n; i++) {
		unsigned int mask;
		const unsigned int bits = bits_asked(m, i, w, &mask);
		const unsigned int other = b->was_read[i] ? b->read[i] :
					   b->image[i];

		b->due[i] = mask && !(b->kept[i] &&
				      (b->image[i] & mask) == bits);
		if (!b->due[i])
			continue;
		b->image[i] = (uint16_t)((other & ~mask) | bits);
		b->kept[i] = false;
	}
}

static int write_registers(struct generator_modbus *m, int from, int to)
{
	const struct bank *b = &m->bank;
	const int err = outcome(m, m->singles ?
		modbus_write_register(m->link, b->address[from],
				      b->image[from]) :
		modbus_write_registers(m->link, b->address[from], to - from,
				       b->image + from));

	m->took_ns = clock_ns(CLOCK_MONOTONIC);
	/* It has it, and tells it or has it after settle_ms. */
	return err == EMBXACK ? 0 : err;
}

/* The slave has it: what was read before is old. */
static void bank_written(struct bank *b, int at)
{
	b->kept[at] = b->was_read[at] = true;
	b->read[at] = b->image[at];
	b->due[at] = false;
}

/* Each alone, to know which one it refuses. */
static int write_singly(struct generator_modbus *m, int from, int to)
{
	struct bank *b = &m->bank;
	int err = 0;

	for (int i = from; i < to && err >= 0; i++) {
		const int one = write_registers(m, i, i + 1);

		if (one > 0 && !is_delay(one))
			refused(m, field_at(m, b->address[i]), one);
		b->kept[i] = false;
		if (one == 0)
			bank_written(b, i);
		err = one ? one : err;
	}
	return err;
}

static int write_run(struct generator_modbus *m, int from, int to)
{
	struct bank *b = &m->bank;
	int err;

	if (m->singles)
		return write_singly(m, from, to);
	err = write_registers(m, from, to);
	if (err < 0 || is_delay(err))
		return err;
	m->singles = err == EMBXILFUN;
	if (err > 0)
		return write_singly(m, from, to);
	for (int i = from; i < to; i++)
		bank_written(b, i);
	return 0;
}

/* Runs of addresses, each a request.  Return: 0, or what one of them came to:
 * the exception, or -errno. */
static int write_due(struct generator_modbus *m)
{
	const struct bank *b = &m->bank;
	int err = 0, one, to;

	for (int from = 0; from < b->n && err >= 0; from = to) {
		to = from + 1;
		if (!b->due[from])
			continue;
		while (to < b->n && b->due[to] &&
		       b->address[to] == b->address[to - 1] + 1)
			to++;
		one = write_run(m, from, to);
		err = one ? one : err;
	}
	return err;
}

/* -- The thread: read ------------------------------------------------------ */

/* A count of 32 bits has two. */
static int registers_of(const struct config_way *w)
{
	return w->bits > 16 ? 2 : 1;
}

static bool is_next(const struct config_way *a, const struct config_way *b)
{
	return a->input == b->input && b->id <= a->id + registers_of(a);
}

/* It tells another value than was written last, there or elsewhere. */
static bool is_odd(const struct generator_modbus *m, int field)
{
	const struct config_way *w = &m->way[field], *t = &m->told[field];
	const struct bank *b = &m->bank;
	const int at = w->kind == WAY_REGISTER ? bank_find(b, w->id) : -1;
	double has;

	if (at < 0 || !b->kept[at])
		return false;
	has = generator_value(w, field, (b->image[at] & mask_of(w)) >> w->bit);
	return !(fabs(generator_value(t, field, m->word.count[field]) - has) <=
		 generator_slack(t));
}

static uint32_t bits_of(const struct config_way *w, const uint16_t *got)
{
	if (w->bits > 16)
		return w->low_first ? got[0] | (uint32_t)got[1] << 16 :
				      got[1] | (uint32_t)got[0] << 16;
	return (uint32_t)got[0] >> w->bit & ((1u << w->bits) - 1);
}

static int read_run(struct generator_modbus *m, const uint8_t *field, int n)
{
	const struct config_way *first = &m->told[field[0]];
	const struct config_way *last = &m->told[field[n - 1]];
	const int span = last->id - first->id + registers_of(last);
	uint16_t got[REGISTERS_MOST];
	const int err = outcome(m, first->input ?
		modbus_read_input_registers(m->link, first->id, span, got) :
		modbus_read_registers(m->link, first->id, span, got));

	if (err > 0 && !is_delay(err))
		refused(m, field[0], err);
	for (int i = 0; i < n && err == 0; i++) {
		const struct config_way *w = &m->told[field[i]];
		const int at = w->input ? -1 : bank_find(&m->bank, w->id);

		if (at >= 0) {
			m->bank.read[at] = got[w->id - first->id];
			m->bank.was_read[at] = true;
		}
		m->word.count[field[i]] = bits_of(w, got + w->id - first->id);
		m->odd = (field[i] < PROCESS_NFIELDS && is_odd(m, field[i])) ||
			 m->odd;
	}
	return err;
}

static uint32_t place_in(const struct config_way *w)
{
	return (uint32_t)w->input << 16 | w->id;
}

static int order(const struct generator_modbus *m,
		 uint8_t ret[PROCESS_NTOLD])
{
	int n = 0;

	for (int i = 0; i < PROCESS_NTOLD; i++) {
		int at = n;

		if (!(m->tells >> i & 1))
			continue;
		for (; at > 0 && place_in(&m->told[ret[at - 1]]) >
				 place_in(&m->told[i]); at--)
			ret[at] = ret[at - 1];
		ret[at] = (uint8_t)i;
		n++;
	}
	return n;
}

/* Is it there?  To say that this cannot be read is an answer too. */
static int read_any(struct generator_modbus *m)
{
	uint16_t got;
	const int err = outcome(m, modbus_read_registers(m->link,
					m->bank.address[0], 1, &got));

	return err < 0 ? err : 0;
}

static int read_told(struct generator_modbus *m)
{
	uint8_t field[PROCESS_NTOLD];
	const int n = order(m, field);
	int err = n ? 0 : read_any(m), to;

	m->odd = false;
	for (int from = 0; from < n && err == 0; from = to) {
		to = from + 1;
		while (to < n && is_next(&m->told[field[to - 1]],
					 &m->told[field[to]]))
			to++;
		err = read_run(m, field + from, to - from);
	}
	return err;
}

/* -- The thread: an exchange ----------------------------------------------- */

static bool connect_up(struct generator_modbus *m)
{
	if (m->up)
		return true;
	if (modbus_connect(m->link) < 0) {
		m->word.err = errno;
		return false;
	}
	m->up = true;
	return true;
}

static void put_word(struct generator_modbus *m)
{
	const struct stamped words = STAMPED(m->words, m->word_next);

	stamped_put(&words, &m->word);
}

/* What it does not tell it has after settle_ms. */
static bool is_settled(const struct generator_modbus *m)
{
	return !m->blind ||
	       clock_ns(CLOCK_MONOTONIC) - m->took_ns >= m->settle_ns;
}

static void take_wish(struct generator_modbus *m, const struct wish *w)
{
	const bool again = w->again != m->again;

	if (!again && w->version == m->took)
		return;
	/* One that has lost something gets all of it. */
	if (again || m->odd || m->lost)
		memset(m->bank.kept, 0, sizeof(m->bank.kept));
	m->lost = false;
	m->word.refused = NONE;
	m->took = w->version;
	m->again = m->word.again = w->again;
}

/* What it has to tell before anything is written: bits that are of others, and
 * whether it has lost something. */
static void meet(struct generator_modbus *m)
{
	const int err = read_told(m);

	m->met = err >= 0 && !is_delay(err);
	if (err == 0) {
		m->word.err = 0;
		m->word.number++;
	}
}

static void exchange(struct generator_modbus *m)
{
	const struct stamped wishes = STAMPED(m->wishes, m->wish_next);
	struct wish w;
	int err;

	if (!stamped_last(&wishes, TRIES, &w))
		return;
	modbus_flush(m->link);
	if (!m->met) {
		meet(m);
		return;
	}
	take_wish(m, &w);
	bank_take(m, &w);
	err = write_due(m);
	if (err < 0 || read_told(m) != 0)
		return;
	m->word.err = 0;
	m->word.number++;
	if (err == 0 && !m->lost && is_settled(m))
		m->word.version = m->took;
}

static void sleep_until(struct generator_modbus *m, int64_t from_ns)
{
	const int64_t least_ns = m->up ? m->every_ns :
				 AGAIN_MS * INT64_C(1000000);
	struct timespec t;
	int64_t left_ns = from_ns + least_ns - clock_ns(CLOCK_MONOTONIC);

	if (left_ns <= 0)
		return;
	clock_gettime(CLOCK_MONOTONIC, &t);
	left_ns += t.tv_nsec;
	t.tv_sec += (time_t)(left_ns / 1000000000);
	t.tv_nsec = (long)(left_ns % 1000000000);
	while (sem_clockwait(&m->wake, CLOCK_MONOTONIC, &t) < 0 &&
	       errno == EINTR)
		;
	while (sem_trywait(&m->wake) == 0)
		;
}

static void *run(void *arg)
{
	struct generator_modbus *m = arg;

	while (!atomic_load(&m->quit)) {
		const int64_t from_ns = clock_ns(CLOCK_MONOTONIC);

		if (connect_up(m))
			exchange(m);
		put_word(m);
		sleep_until(m, from_ns);
	}
	/* What is to be off when edmd ends. */
	if (m->up)
		exchange(m);
	return NULL;
}

/* -- The cycle ------------------------------------------------------------- */

static bool goes_by_register(const struct generator *g, int field)
{
	return g->way[field].kind == WAY_REGISTER && !isnan(g->value[field]);
}

static void modbus_write(struct generator *g)
{
	struct generator_modbus *m = g->modbus;
	const struct stamped wishes = STAMPED(m->wishes, m->wish_next);
	struct wish w = { .version = g->asked, .again = m->last.again };

	for (int i = 0; i < PROCESS_NFIELDS; i++) {
		if (!goes_by_register(g, i))
			continue;
		w.given |= 1u << i;
		w.count[i] = (uint16_t)generator_count(&g->way[i], i,
						       g->value[i]);
	}
	/* What is not asked for any more a person may set. */
	w.again += g->anew || (m->last.given & ~w.given);
	if (m->wish_next && memcmp(&w, &m->last, sizeof(w)) == 0)
		return;
	m->last = w;
	stamped_put(&wishes, &w);
	sem_post(&m->wake);
}

static void note_link(struct generator *g, const struct word *w)
{
	struct generator_modbus *m = g->modbus;

	if (w->err == m->err)
		return;
	m->err = w->err;
	generator_tell(g, &(struct generator_note) {
		.kind = w->err ? GENERATOR_LINK_DOWN : GENERATOR_LINK_BACK,
		.code = w->err });
}

static void take_word(struct generator *g, const struct word *w)
{
	note_link(g, w);
	/* Not one from before a reset. */
	if (w->refused == g->asked && w->refused != NONE &&
	    w->again == g->modbus->last.again)
		generator_refused(g, w->field, w->exception);
	if (w->number == g->modbus->heard)
		return;
	g->modbus->heard = w->number;
	g->taken_version = w->version;
	memset(g->age, 0, sizeof(g->age));
	for (int i = 0; i < PROCESS_NTOLD; i++)
		if (g->modbus->tells >> i & 1)
			generator_hears(g, i, w->count[i]);
}

static void modbus_read(struct generator *g)
{
	struct generator_modbus *m = g->modbus;
	const struct stamped words = STAMPED(m->words, m->word_next);
	const uint64_t next = __atomic_load_n(&m->word_next, __ATOMIC_ACQUIRE);
	struct word w;

	if (next == m->seen || !stamped_last(&words, TRIES, &w))
		return;
	m->seen = next;
	take_word(g, &w);
}

/* -- Open and close -------------------------------------------------------- */

static void forget(struct generator_modbus *m)
{
	if (m->link) {
		modbus_close(m->link);
		modbus_free(m->link);
	}
	sem_destroy(&m->wake);
	free(m);
}

static void modbus_end(struct generator_modbus *m)
{
	atomic_store(&m->quit, true);
	sem_post(&m->wake);
	pthread_join(m->thread, NULL);
	forget(m);
}

static int refuse_port(const struct generator_modbus *m, int err,
		       struct interp_diag *diag)
{
	interp_diag_say(diag, "generator.modbus %s: %s; %s", m->at.host,
			err == ENOTTY ? "is no serial port" : strerror(err),
			err == EACCES || err == EPERM ?
			"edmd in the group of that device, as dialout" :
			CONFIG_MODBUS_WANTED);
	return -err;
}

static int check_port(const struct generator_modbus *m,
		      struct interp_diag *diag)
{
	int fd, err = 0;

	if (!m->at.serial)
		return 0;
	fd = open(m->at.host, O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
	if (fd < 0)
		return refuse_port(m, errno, diag);
	if (!isatty(fd))
		err = ENOTTY;
	close(fd);
	return err ? refuse_port(m, err, diag) : 0;
}

/* The bytes of the longest request and its answer, 11 bits each. */
#define LONGEST_BYTES	(9 + 2 * REGISTERS_MOST + 8)

static void set_times(struct generator_modbus *m,
		      const struct config_generator *g)
{
	const double wire_s = m->at.serial ? LONGEST_BYTES * 11 / g->baud : 0;
	const double s = g->timeout_ms * 1e-3 + wire_s;
	const uint32_t whole = (uint32_t)s;
	const uint32_t us = (uint32_t)((s - whole) * 1e6);

	modbus_set_response_timeout(m->link, whole, us);
	modbus_set_byte_timeout(m->link, whole, us);
	m->every_ns = (int64_t)(g->every_ms * 1e6);
	m->settle_ns = (int64_t)(g->settle_ms * 1e6);
}

static int link_make(struct generator_modbus *m,
		     const struct config_generator *g)
{
	static const char parity[] = { 'E', 'N', 'O' };

	m->link = m->at.serial ?
		modbus_new_rtu(m->at.host, (int)g->baud, parity[g->parity], 8,
			       g->parity == PARITY_NONE ? 2 : 1) :
		modbus_new_tcp_pi(m->at.host, m->at.port);
	if (!m->link || modbus_set_slave(m->link, (int)g->unit) < 0)
		return errno == ENOMEM ? -ENOMEM : -EINVAL;
	set_times(m, g);
	return 0;
}

static struct generator_modbus *modbus_make(struct generator *g,
					    const struct machine_config *c)
{
	struct generator_modbus *m = calloc(1, sizeof(*m));

	if (!m)
		return NULL;
	config_modbus_read(c->generator.modbus, &m->at);
	memcpy(m->way, g->way, sizeof(m->way));
	memcpy(m->told, g->told, sizeof(m->told));
	for (int i = 0; i < PROCESS_NTOLD; i++)
		if (m->told[i].kind == WAY_REGISTER)
			m->tells |= 1u << i;
	for (int i = 0; i < PROCESS_NFIELDS; i++) {
		if (m->way[i].kind != WAY_REGISTER)
			continue;
		bank_add(&m->bank, m->way[i].id);
		m->blind = m->blind || (i < INTERP_NGENERATOR &&
					!(m->tells >> i & 1));
	}
	m->took = m->word.version = m->word.refused = NONE;
	sem_init(&m->wake, 0, 0);
	return m;
}

int generator_modbus_open(struct generator *g, const struct machine_config *c,
			  struct interp_diag *diag)
{
	struct generator_modbus *m = modbus_make(g, c);
	int err;

	if (!m)
		return -ENOMEM;
	err = check_port(m, diag);
	if (err == 0)
		err = link_make(m, &c->generator);
	if (err == -EINVAL)
		interp_diag_say(diag, "generator.modbus %s: libmodbus does not "
				"take it; %s", c->generator.modbus,
				CONFIG_MODBUS_WANTED);
	if (err == 0)
		err = thread_start(&m->thread, &(struct thread) {
			.name = "edmd-modbus", .run = run, .arg = m });
	if (err) {
		forget(m);
		return err;
	}
	g->modbus = m;
	g->takes = true;
	g->taken_version = NONE;
	g->modbus_write = modbus_write;
	g->modbus_read = modbus_read;
	g->modbus_end = modbus_end;
	return 0;
}

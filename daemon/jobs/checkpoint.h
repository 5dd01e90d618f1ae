/* SPDX-License-Identifier: Apache-2.0 */
/*
 * checkpoint.h - where the machine stands, on the disk
 *
 * One file beside the store, MACHINE.place, of four blocks that are made once
 * and then written in place, so that a full disk does not matter:
 *
 *	base 0 | base 1 | place 0 | place 1
 *
 * A base is all that edmd would know after a crash: its snapshot, what was set,
 * which program of which text.  A place is the part of it that changes while it
 * cuts, and fits a sector.  Each has a sequence number and a hash, and is
 * written to the older of its two blocks; a place counts only with the base
 * that it was written for.  A block that was written only in part, or is of
 * another machine, is not used, and the log says so.
 *
 * A place is written when the machine begins or ends to cut, travel, probe, or
 * stand, and then when CHECKPOINT_S of its time or CHECKPOINT_MM of ground have
 * passed.  A base is written when anything else changes.  Both are written at
 * most as often as a budget of CHECKPOINT_DAY_BYTES a day allows.
 *
 * A thread of its own writes, because a memory card may take a second for one
 * write.  Of several checkpoints that come in this time only the last one is
 * written.
 *
 * Units: in every name.  Threads: one, that of the event loop.
 */
#ifndef JOBS_CHECKPOINT_H
#define JOBS_CHECKPOINT_H

#include "shm.h"

#include <stdbool.h>

#define CHECKPOINT_S		0.8	/* of the machine's time */
#define CHECKPOINT_MM		0.04	/* of ground, while it cuts */
#define CHECKPOINT_DAY_BYTES	64e6

struct checkpoint_file;

/* Which job: what is needed to make the same program again. */
struct checkpoint_job {
	uint32_t n;			/* 0: none was loaded */
	uint32_t begun;			/* 1 */
	char id[64];
	uint8_t sha256[32];		/* of its text */
	uint8_t tech[32];		/* of the technology table, or zeros */
	uint8_t config[32];		/* of the machine file */
	int32_t start[SHM_NAXES];	/* pulses, where its path begins */
	uint32_t electrode;		/* that cuts; 0: none */
	uint32_t part, first_part;	/* store_electrode.h: of now, and of
					 * this loading */
	uint32_t run;			/* 0: the first run of the job; each
					 * resume draws a number */
	double by[SHM_NAXES];		/* what the electrode shifts the axes
					 * by; X Y at C 0 */
};

struct checkpoint_base {
	struct checkpoint_job job;
	int64_t utime;
	struct shm_snapshot snap;
	struct shm_sets sets;
	double wear_mm;			/* what this part took off so far */
};

/* As in struct shm_snapshot. */
struct checkpoint_place {
	int64_t utime;
	uint32_t state, seg, tick, line;
	double place_mm, far_mm, back_mm, depth_mm, depth_far_mm;
	int32_t pos[SHM_NAXES], drive[SHM_NAXES], shift[SHM_NAXES];
	int8_t toward[SHM_NAXES];
	uint64_t job_cycles, erode_cycles, jump_cycles;
	double energy_j;
	uint32_t retracts, jumps, shorts, arcs, outcome;
	double wear_mm;			/* as in struct checkpoint_base */
};

/* What was read: the newest whole base and place. */
struct checkpoint {
	bool there;
	struct checkpoint_base base;	/* with the place in its snapshot */
	int64_t utime;			/* when that was */
};

struct checkpoint_stats {
	uint64_t handed, handed_bytes;	/* to the thread that writes */
	uint64_t writes, bytes;		/* written; fewer than handed, because
					 * a newer one replaces one that
					 * waits */
	int err;			/* of the last write; 0 */
	int64_t slowest_us;
};

/**
 * checkpoint_open() - read what is there, make the file if it is not.
 *
 * The log tells which blocks are not used.  Return: 0; -errno: it cannot be
 * written; @ret_last is filled as far as it can be read.
 */
int checkpoint_open(struct checkpoint_file **ret, const char *dir,
		    const char *machine, struct checkpoint *ret_last);
/** checkpoint_close() - what is under way is written first.  NULL is fine. */
void checkpoint_close(struct checkpoint_file *f);

/**
 * checkpoint_look() - look whether @now has to be written; never waits.
 * @now_us: monotonic.
 */
void checkpoint_look(struct checkpoint_file *f,
		     const struct checkpoint_base *now, int64_t now_us);

/** checkpoint_stats() - what was written since it was opened. */
void checkpoint_stats(struct checkpoint_file *f, struct checkpoint_stats *ret);

/* -- checkpoint_block.c --------------------------------------------------- */

/* The blocks contain structs of shm.h. */
#define CHECKPOINT_VERSION	(4 << 16 | SHM_LAYOUT)
#define CHECKPOINT_BLOCK	4096
#define CHECKPOINT_SECTOR	512

enum checkpoint_kind { CHECKPOINT_BASE, CHECKPOINT_PLACE };

/* A block as it stands on the disk; the rest of it is zeros. */
struct checkpoint_head {
	char magic[8];			/* "edmplace" */
	uint32_t version, kind;
	uint64_t sequence;		/* of the base; in a place, of the base
					 * that it belongs to */
	uint64_t count;			/* of the place; grows with each */
	char machine[SHM_NAME_MAX];
	uint8_t hash[16];		/* of the block with this as zeros */
};

union checkpoint_block {
	struct {
		struct checkpoint_head head;
		union {
			struct checkpoint_base base;
			struct checkpoint_place place;
		};
	};
	uint8_t bytes[CHECKPOINT_BLOCK];
};

/** checkpoint_seal() - fill in the hash of a block. */
void checkpoint_seal(union checkpoint_block *b);

/**
 * checkpoint_choose() - choose the newest whole base and place of the four
 * blocks of a file.  @ret_head gets the head of the newest base, to go on from.
 * The log tells which blocks are not whole.
 */
void checkpoint_choose(const union checkpoint_block block[4],
		       const char *machine, struct checkpoint *ret,
		       struct checkpoint_head *ret_head);

/** checkpoint_place_of() - the part of @s that changes in a cut. */
struct checkpoint_place checkpoint_place_of(const struct checkpoint_base *b);

#endif /* JOBS_CHECKPOINT_H */

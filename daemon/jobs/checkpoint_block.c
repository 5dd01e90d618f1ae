/* SPDX-License-Identifier: Apache-2.0 */
/*
 * checkpoint_block.c - the blocks of a checkpoint: sealed, checked, and the
 * newest chosen
 */
#include "checkpoint.h"

#include "jobs_log.h"

#include <sodium.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#define MAGIC	"edmplace"

_Static_assert(sizeof(struct checkpoint_head) +
	       sizeof(struct checkpoint_base) <= CHECKPOINT_BLOCK, "a block");
_Static_assert(sizeof(struct checkpoint_head) +
	       sizeof(struct checkpoint_place) <= CHECKPOINT_SECTOR,
	       "a sector");

/* The hash of a place covers the bytes that are written. */
static size_t bytes_of(const union checkpoint_block *b)
{
	return b->head.kind == CHECKPOINT_BASE ? CHECKPOINT_BLOCK :
						 CHECKPOINT_SECTOR;
}

static void hash_of(const union checkpoint_block *b, uint8_t ret[16])
{
	union checkpoint_block zeroed = *b;

	memset(zeroed.head.hash, 0, sizeof(zeroed.head.hash));
	crypto_generichash(ret, 16, zeroed.bytes, bytes_of(b), NULL, 0);
}

void checkpoint_seal(union checkpoint_block *b)
{
	uint8_t hash[16];

	memcpy(b->head.magic, MAGIC, sizeof(b->head.magic));
	b->head.version = CHECKPOINT_VERSION;
	hash_of(b, hash);
	memcpy(b->head.hash, hash, sizeof(hash));
}

/* NULL: the block is whole; "": it was never written; otherwise what is
 * wrong. */
static const char *wrong(const union checkpoint_block *b,
			 enum checkpoint_kind kind, const char *machine)
{
	static const union checkpoint_block zeros;
	uint8_t hash[16];

	if (memcmp(b, &zeros, sizeof(zeros)) == 0)
		return "";
	if (memcmp(b->head.magic, MAGIC, sizeof(b->head.magic)) != 0)
		return "no checkpoint";
	if (b->head.version != CHECKPOINT_VERSION)
		return "of another version of edmd-jobs";
	if (b->head.kind != (uint32_t)kind)
		return "of another kind";
	hash_of(b, hash);
	if (memcmp(hash, b->head.hash, sizeof(hash)) != 0)
		return "torn: it was written when the power went";
	if (strncmp(b->head.machine, machine, SHM_NAME_MAX) != 0)
		return "of another machine";
	return NULL;
}

static bool is_whole(const union checkpoint_block *b,
		     enum checkpoint_kind kind, int i, const char *machine)
{
	const char *why = wrong(b, kind, machine);

	if (why && *why)
		log_warning("checkpoint: %s %d is %s; the other one counts",
			    kind == CHECKPOINT_BASE ? "base" : "place", i, why);
	return !why;
}

struct checkpoint_place checkpoint_place_of(const struct checkpoint_base *b)
{
	const struct shm_snapshot *s = &b->snap;
	struct checkpoint_place p = {
		.utime = b->utime, .state = s->state, .seg = s->seg,
		.tick = s->tick, .line = s->line, .place_mm = s->place_mm,
		.far_mm = s->far_mm, .back_mm = s->back_mm,
		.depth_mm = s->depth_mm, .depth_far_mm = s->depth_far_mm,
		.job_cycles = s->job_cycles,
		.erode_cycles = s->erode_cycles, .jump_cycles = s->jump_cycles,
		.retracts = s->retracts, .jumps = s->jumps,
		.shorts = s->shorts, .arcs = s->arcs,
		.energy_j = s->energy_j, .outcome = s->outcome,
		.wear_mm = b->wear_mm,
	};

	memcpy(p.pos, s->pos, sizeof(p.pos));
	memcpy(p.drive, s->drive, sizeof(p.drive));
	memcpy(p.shift, s->shift, sizeof(p.shift));
	memcpy(p.toward, s->toward, sizeof(p.toward));
	return p;
}

static void put_place(struct checkpoint_base *b,
		      const struct checkpoint_place *p)
{
	struct shm_snapshot *s = &b->snap;

	b->utime = p->utime;
	b->wear_mm = p->wear_mm;
	s->state = p->state;
	s->seg = p->seg;
	s->tick = p->tick;
	s->line = p->line;
	s->place_mm = p->place_mm;
	s->far_mm = p->far_mm;
	s->back_mm = p->back_mm;
	s->depth_mm = p->depth_mm;
	s->depth_far_mm = p->depth_far_mm;
	s->job_cycles = p->job_cycles;
	s->erode_cycles = p->erode_cycles;
	s->jump_cycles = p->jump_cycles;
	s->retracts = p->retracts;
	s->jumps = p->jumps;
	s->shorts = p->shorts;
	s->arcs = p->arcs;
	s->energy_j = p->energy_j;
	s->outcome = p->outcome;
	memcpy(s->pos, p->pos, sizeof(s->pos));
	memcpy(s->drive, p->drive, sizeof(s->drive));
	memcpy(s->shift, p->shift, sizeof(s->shift));
	memcpy(s->toward, p->toward, sizeof(s->toward));
}

void checkpoint_choose(const union checkpoint_block block[4],
		       const char *machine, struct checkpoint *ret,
		       struct checkpoint_head *ret_head)
{
	const union checkpoint_block *base = NULL, *place = NULL;

	*ret = (struct checkpoint) { .there = false };
	*ret_head = (struct checkpoint_head) { .sequence = 0 };
	for (int i = 0; i < 2; i++)
		if (is_whole(&block[i], CHECKPOINT_BASE, i, machine) &&
		    (!base || block[i].head.sequence > base->head.sequence))
			base = &block[i];
	if (!base)
		return;
	for (int i = 0; i < 2; i++) {
		const union checkpoint_block *b = &block[2 + i];

		if (!is_whole(b, CHECKPOINT_PLACE, i, machine))
			continue;
		ret_head->count = b->head.count > ret_head->count ?
				  b->head.count : ret_head->count;
		if (b->head.sequence == base->head.sequence &&
		    (!place || b->head.count > place->head.count))
			place = b;
	}
	ret_head->sequence = base->head.sequence;
	ret->there = true;
	ret->base = base->base;
	if (place)
		put_place(&ret->base, &place->place);
	ret->utime = ret->base.utime;
}

/* SPDX-License-Identifier: Apache-2.0 */
/*
 * topic.h - the fleet's DDS topics and their quality of service
 *
 * Here is everything on which writer and reader have to agree.  docs/fleet.md
 * is for those who write another reader.
 *
 * Threads: startup only, but for topic_has_writer() and topic_is_of().
 */
#ifndef DDS_TOPIC_H
#define DDS_TOPIC_H

#include "dds/dds.h"
#include "edm.h"

#include <stdbool.h>

enum topic {
	TOPIC_STATE, TOPIC_REPORT, TOPIC_ALARM, TOPIC_SCOPE, TOPIC_OFFER,
	TOPIC_ANSWER, TOPIC_NTOPICS
};

/* What a machine tells is in a partition with its name. */
#define TOPIC_ALL_PARTS	"*"

/* Each participant of an edm-dds has a name that begins so. */
#define TOPIC_DDS	"edm-dds "

/*
 * A writer promises a sample each second, and each sample is a sign of life.  A
 * writer that is silent for two seconds is gone.  edm-dds sends at least 2 Hz.
 */
#define TOPIC_DEADLINE	DDS_SECS(1)
#define TOPIC_LEASE	DDS_SECS(2)
#define TOPIC_HZ_MIN	2.0

#define TOPIC_KEPT_MAX	4096		/* reports, and alarms, of a machine */

/**
 * topic_writer_create() - @owner: participant or publisher.
 * Return: the writer, or a negative DDS code.
 */
dds_entity_t topic_writer_create(dds_entity_t owner, enum topic which);

/**
 * topic_reader_create() - @owner: participant or subscriber.
 * Return: the reader, or a negative DDS code.
 */
dds_entity_t topic_reader_create(dds_entity_t owner, enum topic which);

/**
 * topic_part_create() - a publisher (@writes) or a subscriber, of partition
 * @name.  Return: it, or a negative DDS code.
 */
dds_entity_t topic_part_create(dds_entity_t participant, bool writes,
			       const char *name);

/**
 * topic_is_of() - does @writer write in the partition of @machine, and nowhere
 * else?  DDS Security lets only the machine itself do so.  Not of one that has
 * left.
 */
bool topic_is_of(dds_entity_t reader, dds_instance_handle_t writer,
		 const char *machine);

/** topic_has_writer() - does @reader still see this one? */
bool topic_has_writer(dds_entity_t reader, dds_instance_handle_t writer);

/**
 * topic_domain_parse() - a domain number from the command line.
 *
 * Return: 0, or -EINVAL if @word is not a number from 0 to 230.
 */
int topic_domain_parse(const char *word, dds_domainid_t *ret);

/** topic_number_parse() - a number from @min to @max, or -EINVAL. */
int topic_number_parse(const char *word, double min, double max, double *ret);

#endif /* DDS_TOPIC_H */

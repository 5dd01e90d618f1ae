/* SPDX-License-Identifier: Apache-2.0 */
/* topic.c - the fleet's one DDS topic and its quality of service */
#include "topic.h"

#include <errno.h>
#include <stdlib.h>

/* The ports are 7400 + 250 * domain; above 230 they do not fit. */
#define DOMAIN_MAX	230

dds_entity_t topic_create(dds_entity_t participant)
{
	return dds_create_topic(participant, &edm_MachineState_desc,
				TOPIC_NAME, NULL, NULL);
}

static dds_qos_t *qos_create(void)
{
	dds_qos_t *qos = dds_create_qos();

	dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_MSECS(100));
	dds_qset_durability(qos, DDS_DURABILITY_TRANSIENT_LOCAL);
	dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, 1);
	return qos;
}

/*
 * Manual by topic: only a written sample is a sign of life.  So a writer that
 * hangs is noticed in the same way as one that died.
 */
dds_entity_t topic_writer_create(dds_entity_t participant, dds_entity_t topic)
{
	dds_qos_t *qos = qos_create();
	dds_entity_t writer;

	dds_qset_deadline(qos, TOPIC_DEADLINE);
	dds_qset_liveliness(qos, DDS_LIVELINESS_MANUAL_BY_TOPIC, TOPIC_LEASE);
	dds_qset_writer_data_lifecycle(qos, true);
	writer = dds_create_writer(participant, topic, qos, NULL);
	dds_delete_qos(qos);
	return writer;
}

/* A reader must not ask for a deadline: it would not match a slower
 * publisher. */
dds_entity_t topic_reader_create(dds_entity_t participant, dds_entity_t topic)
{
	dds_qos_t *qos = qos_create();
	dds_entity_t reader;

	reader = dds_create_reader(participant, topic, qos, NULL);
	dds_delete_qos(qos);
	return reader;
}

int topic_number_parse(const char *word, double min, double max, double *ret)
{
	char *end;
	double v;

	errno = 0;
	v = strtod(word, &end);
	if (end == word || *end || errno || !(v >= min && v <= max))
		return -EINVAL;

	*ret = v;
	return 0;
}

int topic_domain_parse(const char *word, dds_domainid_t *ret)
{
	double v;

	if (topic_number_parse(word, 0, DOMAIN_MAX, &v) < 0 ||
	    v != (double)(dds_domainid_t)v)
		return -EINVAL;

	*ret = (dds_domainid_t)v;
	return 0;
}

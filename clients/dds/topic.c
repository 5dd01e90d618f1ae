/* SPDX-License-Identifier: Apache-2.0 */
/* topic.c - the fleet's DDS topics and their quality of service */
#include "topic.h"

#include <errno.h>
#include <stdlib.h>

/* The ports are 7400 + 250 * domain; above 230 they do not fit. */
#define DOMAIN_MAX	230

static const struct topic_row {
	const char *name;
	const dds_topic_descriptor_t *type;
} topics[TOPIC_NTOPICS] = {
	[TOPIC_STATE] = { "EDM_MachineState", &edm_MachineState_desc },
	[TOPIC_REPORT] = { "EDM_JobReport", &edm_JobReport_desc },
	[TOPIC_ALARM] = { "EDM_Alarm", &edm_Alarm_desc },
};

/* Of each instance only the last counts.  The writer takes back reports and
 * alarms that are older than a day: reports.c. */
static dds_qos_t *qos_create(void)
{
	dds_qos_t *qos = dds_create_qos();

	dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_MSECS(100));
	dds_qset_durability(qos, DDS_DURABILITY_TRANSIENT_LOCAL);
	dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, 1);
	return qos;
}

static dds_entity_t create(dds_entity_t participant, enum topic which)
{
	return dds_create_topic(participant, topics[which].type,
				topics[which].name, NULL, NULL);
}

/*
 * A state is manual by topic: only a written sample is a sign of life.  So a
 * writer that hangs is noticed in the same way as one that died.
 */
dds_entity_t topic_writer_create(dds_entity_t participant, enum topic which)
{
	const dds_entity_t topic = create(participant, which);
	dds_qos_t *qos = qos_create();
	dds_entity_t writer;

	if (which == TOPIC_STATE) {
		dds_qset_deadline(qos, TOPIC_DEADLINE);
		dds_qset_liveliness(qos, DDS_LIVELINESS_MANUAL_BY_TOPIC,
				    TOPIC_LEASE);
	}
	dds_qset_writer_data_lifecycle(qos, which == TOPIC_STATE);
	writer = topic < 0 ? topic :
			     dds_create_writer(participant, topic, qos, NULL);
	dds_delete_qos(qos);
	return writer;
}

/*
 * A reader must not ask for a deadline: it would not match a slower publisher.
 * It has room for what two writers of one machine say between two looks, so
 * that both are seen.
 */
dds_entity_t topic_reader_create(dds_entity_t participant, enum topic which)
{
	const dds_entity_t topic = create(participant, which);
	dds_qos_t *qos = qos_create();
	dds_entity_t reader;

	if (which == TOPIC_STATE)
		dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, 32);
	reader = topic < 0 ? topic :
			     dds_create_reader(participant, topic, qos, NULL);
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

/* SPDX-License-Identifier: Apache-2.0 */
/* topic.c - the fleet's DDS topics and their quality of service */
#include "topic.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

/* The ports are 7400 + 250 * domain; above 230 they do not fit. */
#define DOMAIN_MAX	230

static const struct topic_row {
	const char *name;
	const dds_topic_descriptor_t *type;
	dds_durability_kind_t kept;
	int32_t written, read;		/* samples of an instance that count */
} topics[TOPIC_NTOPICS] = {
	/* Room for what two writers of one machine say between two looks, so
	 * that both are seen. */
	[TOPIC_STATE] = { "EDM_MachineState", &edm_MachineState_desc,
			  DDS_DURABILITY_TRANSIENT_LOCAL, 1, 32 },
	/* The writer takes back what is older than a day: reports.c. */
	[TOPIC_REPORT] = { "EDM_JobReport", &edm_JobReport_desc,
			   DDS_DURABILITY_TRANSIENT_LOCAL, 1, 1 },
	[TOPIC_ALARM] = { "EDM_Alarm", &edm_Alarm_desc,
			  DDS_DURABILITY_TRANSIENT_LOCAL, 1, 1 },
	/* Who is slow misses some. */
	[TOPIC_SCOPE] = { "EDM_Scope", &edm_Scope_desc,
			  DDS_DURABILITY_VOLATILE, 32, 128 },
	/* Good for a second; who sent it says it again: post.h. */
	[TOPIC_OFFER] = { "EDM_JobOffer", &edm_SignedPacket_desc,
			  DDS_DURABILITY_VOLATILE, 32, 128 },
	[TOPIC_ANSWER] = { "EDM_JobAnswer", &edm_SignedPacket_desc,
			   DDS_DURABILITY_VOLATILE, 32, 128 },
};

static dds_qos_t *qos_create(enum topic which, int32_t samples)
{
	dds_qos_t *qos = dds_create_qos();

	dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_MSECS(100));
	dds_qset_durability(qos, topics[which].kept);
	dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, samples);
	return qos;
}

static dds_entity_t create(dds_entity_t owner, enum topic which)
{
	return dds_create_topic(dds_get_participant(owner), topics[which].type,
				topics[which].name, NULL, NULL);
}

/*
 * A state is manual by topic: only a written sample is a sign of life.  So a
 * writer that hangs is noticed in the same way as one that died.
 */
dds_entity_t topic_writer_create(dds_entity_t owner, enum topic which)
{
	const dds_entity_t topic = create(owner, which);
	dds_qos_t *qos = qos_create(which, topics[which].written);
	dds_entity_t writer;

	if (which == TOPIC_STATE) {
		dds_qset_deadline(qos, TOPIC_DEADLINE);
		dds_qset_liveliness(qos, DDS_LIVELINESS_MANUAL_BY_TOPIC,
				    TOPIC_LEASE);
	}
	dds_qset_writer_data_lifecycle(qos, which == TOPIC_STATE);
	writer = topic < 0 ? topic :
			     dds_create_writer(owner, topic, qos, NULL);
	dds_delete_qos(qos);
	return writer;
}

/* A reader must not ask for a deadline: it would not match a slower
 * publisher. */
dds_entity_t topic_reader_create(dds_entity_t owner, enum topic which)
{
	const dds_entity_t topic = create(owner, which);
	dds_qos_t *qos = qos_create(which, topics[which].read);
	const dds_entity_t reader =
		topic < 0 ? topic : dds_create_reader(owner, topic, qos, NULL);

	dds_delete_qos(qos);
	return reader;
}

dds_entity_t topic_part_create(dds_entity_t participant, bool writes,
			       const char *name)
{
	dds_qos_t *qos = dds_create_qos();
	dds_entity_t part;

	dds_qset_partition1(qos, name);
	part = writes ? dds_create_publisher(participant, qos, NULL) :
			dds_create_subscriber(participant, qos, NULL);
	dds_delete_qos(qos);
	return part;
}

bool topic_is_of(dds_entity_t reader, dds_instance_handle_t writer,
		 const char *machine)
{
	dds_builtintopic_endpoint_t *e =
		dds_get_matched_publication_data(reader, writer);
	char **part = NULL;
	uint32_t n = 0;
	bool is;

	is = e && dds_qget_partition(e->qos, &n, &part) && n == 1 &&
	     strcmp(part[0], machine) == 0;
	for (uint32_t i = 0; i < n; i++)
		dds_free(part[i]);
	dds_free(part);
	if (e)
		dds_builtintopic_free_endpoint(e);
	return is;
}

bool topic_has_writer(dds_entity_t reader, dds_instance_handle_t writer)
{
	dds_builtintopic_endpoint_t *e =
		dds_get_matched_publication_data(reader, writer);

	if (e)
		dds_builtintopic_free_endpoint(e);
	return e;
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

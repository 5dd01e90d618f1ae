/* SPDX-License-Identifier: Apache-2.0 */
/* post.c - signed packets between who offers a job and a machine */
#include "post.h"

#include <string.h>
#include <sys/eventfd.h>
#include <unistd.h>

/* A thread of DDS. */
static void on_data(dds_entity_t reader, void *arg)
{
	const struct post *p = arg;

	(void)reader;
	eventfd_write(p->fd, 1);
}

static void open_ends(struct post *p, dds_entity_t participant,
		      const char *machine, enum topic out)
{
	const enum topic in = out == TOPIC_OFFER ? TOPIC_ANSWER : TOPIC_OFFER;

	p->publisher = topic_part_create(participant, true, machine);
	p->subscriber = topic_part_create(participant, false, machine);
	p->writer = topic_writer_create(p->publisher, out);
	p->reader = topic_reader_create(p->subscriber, in);
}

int post_open(struct post *p, dds_entity_t participant, const char *machine,
	      enum topic out)
{
	dds_listener_t *heard = dds_create_listener(p);
	int err;

	*p = (struct post) { .fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK) };
	p->in = dds_alloc(sizeof(*p->in));
	open_ends(p, participant, machine, out);
	dds_lset_data_available(heard, on_data);
	err = p->fd < 0 ? DDS_RETCODE_OUT_OF_RESOURCES :
	      p->writer < 0 ? p->writer :
	      p->reader < 0 ? p->reader : dds_set_listener(p->reader, heard);
	dds_delete_listener(heard);
	return err;
}

void post_close(struct post *p)
{
	if (p->publisher > 0)
		dds_delete(p->publisher);
	if (p->subscriber > 0)
		dds_delete(p->subscriber);
	if (p->in)
		dds_sample_free(p->in, &edm_SignedPacket_desc, DDS_FREE_ALL);
	if (p->in && p->fd >= 0)
		close(p->fd);
	*p = (struct post) { .fd = -1 };
}

void post_send(struct post *p, const char *channel, const void *data,
	       size_t size)
{
	edm_SignedPacket m = {
		.packet = {
			._length = (uint32_t)size, ._maximum = (uint32_t)size,
			._buffer = (uint8_t *)(uintptr_t)data,
		},
	};
	const size_t n = strlen(channel);

	if (n >= sizeof(m.channel))
		return;
	memcpy(m.channel, channel, n);
	dds_write(p->writer, &m);
}

static bool take(struct post *p, struct udpm_packet *ret,
		 dds_instance_handle_t *ret_from)
{
	dds_sample_info_t info;
	void *at = p->in;

	while (dds_take(p->reader, &at, &info, 1, 1) == 1) {
		if (!info.valid_data)
			continue;
		*ret = (struct udpm_packet) {
			.channel = p->in->channel,
			.data = p->in->packet._buffer,
			.size = p->in->packet._length, .from = "DDS",
		};
		if (ret_from)
			*ret_from = info.publication_handle;
		return true;
	}
	return false;
}

/* What comes after the descriptor was read makes it readable again. */
bool post_take(struct post *p, struct udpm_packet *ret,
	       dds_instance_handle_t *ret_from)
{
	eventfd_t n;

	if (take(p, ret, ret_from))
		return true;
	return eventfd_read(p->fd, &n) == 0 && take(p, ret, ret_from);
}

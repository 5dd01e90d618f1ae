/* SPDX-License-Identifier: Apache-2.0 */
/*
 * plc_files.c - the table of signals as files that PLC tools read
 */
#include "plc.h"

#include <inttypes.h>

/* Numbers of CiA 301 for the types of the table. */
static unsigned int data_type(enum plc_type t)
{
	static const unsigned int types[] = {
		[PLC_U8] = 0x05, [PLC_U16] = 0x06, [PLC_U32] = 0x07,
		[PLC_I16] = 0x03, [PLC_I32] = 0x04,
	};

	return types[t];
}

static void eds_value(FILE *f, const char *name, enum plc_type t,
		      const char *access, bool mapped)
{
	fprintf(f, "ParameterName=%s\nObjectType=0x7\nDataType=0x%04x\n"
		"AccessType=%s\nPDOMapping=%d\n", name, data_type(t), access,
		mapped);
}

static void eds_constant(FILE *f, const struct plc_constant *c)
{
	eds_value(f, c->name, c->type, c->live == PLC_ERRORS ? "rw" : "ro",
		  false);
	if (c->live == PLC_PLUS_NODE)
		fprintf(f, "DefaultValue=$NODEID+0x%" PRIx32 "\n", c->value);
	else
		fprintf(f, "DefaultValue=0x%" PRIx32 "\n", c->value);
	fputc('\n', f);
}

static void eds_signal(FILE *f, const struct plc_signal *s)
{
	eds_value(f, s->name, s->type, s->asked ? "rww" : "ro", s->pdo > 0);
	fprintf(f, "LowLimit=%" PRId64 "\nHighLimit=%" PRId64 "\n\n", s->min,
		s->max);
}

static size_t subs_of(uint16_t index)
{
	size_t n = 0;

	for (size_t i = 0; i < plc_nconstants; i++)
		n += plc_constant[i].index == index;
	for (size_t i = 0; i < plc_nsignals; i++)
		n += plc_signal[i].index == index;
	return n;
}

/* "Machine, highest sub-index" is the record "Machine". */
static void eds_record(FILE *f, const struct plc_constant *c)
{
	int n = 0;

	while (c->name[n] && c->name[n] != ',')
		n++;
	fprintf(f, "[%04X]\nParameterName=%.*s\nObjectType=0x9\n"
		"SubNumber=%zu\n\n", c->index, n, c->name, subs_of(c->index));
}

static void eds_index(FILE *f, uint16_t index)
{
	const bool alone = subs_of(index) == 1;

	for (size_t i = 0; i < plc_nconstants; i++) {
		const struct plc_constant *c = &plc_constant[i];

		if (c->index != index)
			continue;
		if (alone)
			fprintf(f, "[%04X]\n", index);
		else if (c->sub == 0)
			eds_record(f, c);
		if (!alone)
			fprintf(f, "[%04Xsub%X]\n", index, c->sub);
		eds_constant(f, c);
	}
	for (size_t i = 0; i < plc_nsignals; i++) {
		if (plc_signal[i].index != index)
			continue;
		fprintf(f, "[%04Xsub%X]\n", index, plc_signal[i].sub);
		eds_signal(f, &plc_signal[i]);
	}
}

/* Every object has a constant at sub-index 0, in rising order. */
static void eds_list(FILE *f, const char *name, uint16_t from, uint16_t to)
{
	unsigned int n = 0;

	for (int print = 0; print < 2; print++) {
		if (print)
			fprintf(f, "[%s]\nSupportedObjects=%u\n", name, n);
		n = 0;
		for (size_t i = 0; i < plc_nconstants; i++) {
			const struct plc_constant *c = &plc_constant[i];

			if (c->sub != 0 || c->index < from || c->index > to ||
			    c->index == 0x1000 || c->index == 0x1001 ||
			    c->index == 0x1018)
				continue;
			n++;
			if (print)
				fprintf(f, "%u=0x%04X\n", n, c->index);
		}
	}
	fputc('\n', f);
}

void plc_eds(FILE *f)
{
	fputs("; SPDX-License-Identifier: Apache-2.0\n"
	      "; Printed by: edmd --print-eds\n\n"
	      "[FileInfo]\nFileName=edmd.eds\nFileVersion=1\n"
	      "FileRevision=1\nEDSVersion=4.0\n"
	      "Description=edmd, controller of a spark erosion machine\n"
	      "CreationTime=00:00AM\nCreationDate=01-01-2026\n"
	      "CreatedBy=edmd\nModificationTime=00:00AM\n"
	      "ModificationDate=01-01-2026\nModifiedBy=edmd\n\n"
	      "[DeviceInfo]\nVendorName=edmd\nVendorNumber=0x0\n"
	      "ProductName=edmd\nProductNumber=0x65646d64\n"
	      "RevisionNumber=1\nOrderCode=edmd\nBaudRate_10=1\n"
	      "BaudRate_20=1\nBaudRate_50=1\nBaudRate_125=1\n"
	      "BaudRate_250=1\nBaudRate_500=1\nBaudRate_800=1\n"
	      "BaudRate_1000=1\nSimpleBootUpMaster=0\n"
	      "SimpleBootUpSlave=1\nGranularity=0\n"
	      "DynamicChannelsSupported=0\nGroupMessaging=0\n"
	      "NrOfRXPDO=1\nNrOfTXPDO=4\nLSS_Supported=0\n\n"
	      "[MandatoryObjects]\nSupportedObjects=3\n1=0x1000\n"
	      "2=0x1001\n3=0x1018\n\n", f);
	eds_list(f, "OptionalObjects", 0x1000, 0x1fff);
	eds_list(f, "ManufacturerObjects", 0x2000, 0x5fff);
	for (size_t i = 0; i < plc_nconstants; i++) {
		if (plc_constant[i].sub == 0)
			eds_index(f, plc_constant[i].index);
	}
}

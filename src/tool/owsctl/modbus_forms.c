/* SPDX-License-Identifier: MIT */
/*
 * Writes a form: its texts, with the word after each $ replaced. What the programs take stands in
 * their own documentation: PLCopen TC6 XML 2.01, STEP 7's external sources, the nodes of
 * node-red-contrib-modbus, the configuration of OpenPLC's Modbus master, mb2hal(1), mbpoll(1).
 */
#include <stdlib.h>
#include <string.h>

#include "src/faces/modbus/layout.h"
#include "src/tool/owsctl/modbus_forms.h"

#define ID_MOST 256
#define ID_MOST_HAL 28 /* with the rest of a pin 47, above which mb2hal does not start */
#define ID_PLACE 6     /* "_P2047" */

const char *const modbus_cell_names[MODBUS_CELL_COUNT] = {
#define X(name) #name,
	MODBUS_CELLS(X)
#undef X
};

struct escape {
	char character;
	const char *text;
};
static const struct escape in_csv[] = {{'"', "\"\""}, {0}};
static const struct escape in_json[] = {{'"', "\\\""}, {'\\', "\\\\"}, {'\t', "\\t"}, {0}};
static const struct escape in_xml[] = {
	{'&', "&amp;"}, {'<', "&lt;"}, {'>', "&gt;"}, {'"', "&quot;"}, {0}};
static const struct escape in_text[] = {{0}};

struct modbus_form {
	const char *name;
	const struct escape *escape;
	bool removed; /* has the places of signals that are gone, too */
	const char *head, *row, *foot;
	size_t id_most; /* of an identifier; 0: as long as ours are */
};

/* A record, in the order of its registers. */
#define FIELDS(X) \
	X("Float64", "LREAL") \
	X("Float32", "REAL") \
	X("Int32", "DINT") \
	X("Int16", "INT") \
	X("Quality", "UINT") \
	X("Age", "UDINT") \
	X("Alarm", "WORD") \
	X("Count", "UINT") \
	X("Decimals", "UINT") \
	X("Flags", "WORD")
#define XML_FIELD(name, type) \
	"          <variable name=\"" name "\"><type><" type "/></type></variable>\n"
#define SCL_FIELD(name, type) "      " name " : " type ";\n"
#define XML_FIELDS FIELDS(XML_FIELD)
#define SCL_FIELDS FIELDS(SCL_FIELD)

/* mb2hal keeps the last values when the connection is lost: only the heart shows that. */
_Static_assert(LAYOUT_LIVE == 3 && LAYOUT_HEART == 4, "MB2HAL() reads them with one request");
#define MB2HAL(index, first, pins, name) \
	"[TRANSACTION_" index "]\nLINK_TYPE=tcp\nTCP_IP=$host\nTCP_PORT=$port\n" \
	"MB_SLAVE_ID=1\nFIRST_ELEMENT=" first "\nPIN_NAMES=" pins "\n" \
	"MAX_UPDATE_RATE=2.0\nMB_RESPONSE_TIMEOUT_MS=500\n" \
	"MB_TX_CODE=fnct_03_read_holding_registers\nHAL_TX_NAME=" name "\n"

static const struct modbus_form forms[] = {
	{"csv", in_csv, true, "place,record,float32,float64,name,type,io,unit,identity\n",
         "\"$place\",\"$record\",\"$float32\",\"$float64\",\"$name\",\"$type\",\"$io\",\"$unit\","
         "\"$identity\"\n",
         ""},
	/* the file of the key Map */
	{"map", in_text, true, "", "$place $identity\n", ""},
	/* CODESYS reads global variables there alone, and no configuration */
	{"plcopen", in_xml, false,
         "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n"
         "<project xmlns=\"http://www.plcopen.org/xml/tc6_0200\">\n"
         "  <fileHeader companyName=\"\" productName=\"owsctl\" productVersion=\"1\" "
         "creationDateTime=\"2000-01-01T00:00:00\"/>\n"
         "  <contentHeader name=\"owsd $instance\">\n"
         "    <coordinateInfo><fbd><scaling x=\"1\" y=\"1\"/></fbd><ld><scaling x=\"1\" y=\"1\"/>"
         "</ld><sfc><scaling x=\"1\" y=\"1\"/></sfc></coordinateInfo>\n"
         "  </contentHeader>\n"
         "  <types>\n    <dataTypes>\n      <dataType name=\"OwsdSignal\">\n"
         "        <baseType><struct>\n" XML_FIELDS
         "        </struct></baseType>\n      </dataType>\n    </dataTypes>\n    <pous/>\n"
         "  </types>\n  <instances><configurations/></instances>\n"
         "  <addData>\n    <data name=\"http://www.3s-software.com/plcopenxml/globalvars\" "
         "handleUnknown=\"implementation\">\n"
         "      <globalVars name=\"Owsd\" constant=\"true\">\n",
         "        <variable name=\"$id\"><type><INT/></type><initialValue>"
         "<simpleValue value=\"$place\"/></initialValue><documentation>"
         "<xhtml xmlns=\"http://www.w3.org/1999/xhtml\">register $record: $identity $unit</xhtml>"
         "</documentation></variable>\n",
         "      </globalVars>\n    </data>\n  </addData>\n</project>\n"},
	{"scl", in_text, false,
         "TYPE \"OwsdSignal\"\nVERSION : 0.1\n   STRUCT\n" SCL_FIELDS "   END_STRUCT;\nEND_TYPE\n\n"
         "DATA_BLOCK \"Owsd\"\n{ S7_Optimized_Access := 'FALSE' }\nVERSION : 0.1\nNON_RETAIN\n"
         "   STRUCT\n",
         "      \"$id\" : \"OwsdSignal\";   // MB_DATA_ADDR $record: $identity $unit\n",
         "   END_STRUCT;\nBEGIN\nEND_DATA_BLOCK\n"},
	{"node-red", in_json, false,
         "[{\"id\":\"0a5d000000000001\",\"type\":\"tab\",\"label\":\"owsd $instance\"},\n"
         "{\"id\":\"0a5d000000000002\",\"type\":\"modbus-client\",\"name\":\"owsd-modbus\","
         "\"clienttype\":\"tcp\",\"bufferCommands\":true,\"tcpHost\":\"$host\","
         "\"tcpPort\":\"$port\",\"tcpType\":\"DEFAULT\",\"unit_id\":\"1\",\"commandDelay\":\"1\","
         "\"clientTimeout\":\"1000\",\"reconnectOnTimeout\":true,\"reconnectTimeout\":\"2000\","
         "\"parallelUnitIdsAllowed\":true},\n"
         "{\"id\":\"0a5d000000000003\",\"type\":\"function\",\"z\":\"0a5d000000000001\","
         "\"name\":\"record\",\"func\":\"const view = new DataView(new ArrayBuffer(32));\\n"
         "msg.payload.forEach((word, i) => view.setUint16(2 * i, word));\\n"
         "const value = view.getFloat64(0), age = view.getUint32(20);\\n"
         "return {topic: msg.topic, payload: Number.isNaN(value) ? null : value,\\n"
         "    quality: view.getUint16(18), age: age === 0xffffffff ? null : age / 10,\\n"
         "    alarm: view.getUint16(24)};\",\"outputs\":1,\"x\":400,\"y\":60,"
         "\"wires\":[[\"0a5d000000000004\"]]},\n"
         "{\"id\":\"0a5d000000000004\",\"type\":\"debug\",\"z\":\"0a5d000000000001\","
         "\"name\":\"signals\",\"active\":true,\"tosidebar\":true,\"complete\":\"true\","
         "\"targetType\":\"full\",\"x\":580,\"y\":60,\"wires\":[]}",
         ",\n{\"id\":\"0a5d0001$place8\",\"type\":\"modbus-read\",\"z\":\"0a5d000000000001\","
         "\"name\":\"$name\",\"topic\":\"$name\",\"unitid\":\"1\",\"dataType\":\"HoldingRegister\","
         "\"adr\":\"$record\",\"quantity\":\"16\",\"rate\":\"1\",\"rateUnit\":\"s\","
         "\"showErrors\":true,\"server\":\"0a5d000000000002\",\"x\":160,\"y\":$y,"
         "\"wires\":[[\"0a5d000000000003\"],[]]}",
         "]\n"},
	{"openplc", in_json, false,
         "[{\"name\":\"owsd_$instance\",\"protocol\":\"MODBUS\",\"config\":{\"type\":\"SLAVE\","
         "\"transport\":\"tcp\",\"host\":\"$host\",\"port\":$port,\"timeout_ms\":1000,"
         "\"slave_id\":1,\"io_points\":[\n",
         "$comma{\"fc\":3,\"offset\":\"$float32\",\"iec_location\":\"%ID$place\",\"len\":1,"
         "\"cycle_time_ms\":1000},\n"
         "{\"fc\":3,\"offset\":\"$quality\",\"iec_location\":\"%IW$place\",\"len\":1,"
         "\"cycle_time_ms\":1000}",
         "\n]}}]\n"},
	{"mb2hal", in_text, false,
         "[MB2HAL_INIT]\nINIT_DEBUG=1\nVERSION=1.1\nHAL_MODULE_NAME=owsd\nSLOWDOWN=0.0\n"
         "TOTAL_TRANSACTIONS=$transactions\n\n" MB2HAL("00", "3", "live,heart", "owsd-modbus"),
         "\n# $name $unit, $identity\n" MB2HAL("$index", "$int16", "value,quality", "$id"), "",
         ID_MOST_HAL},
	{"mbpoll", in_text, false, "",
         "mbpoll -m tcp -p $port -0 -1 -t 4:float -B -r $float32 -c 1 $host # $name $unit\n", ""},
};
#define FORMS (sizeof(forms) / sizeof(forms[0]))

const struct modbus_form *modbus_form_find(const char *name)
{
	for (size_t i = 0; i < FORMS; i++)
		if (!strcmp(forms[i].name, name))
			return &forms[i];
	return NULL;
}

const char *modbus_form_names(void)
{
	static char names[128];
	size_t at = 0;

	for (size_t i = 0; i < FORMS; i++)
		at += (size_t)snprintf(names + at, sizeof(names) - at, "%s%s", i ? " " : "",
		                       forms[i].name);
	return names;
}

static bool is_letter(char c)
{
	return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

/*
 * An identifier of IEC 61131-3, whose case counts for nothing. A name that is none, or too long for
 * one, gets the place, and so does one with a twin, so that no two agree.
 */
static const char *identifier(const char *const *cells, bool twin, size_t most, char id[ID_MOST])
{
	const char *name = cells[MODBUS_CELL_name];
	size_t at = 0;
	bool same = !twin;

	if (!is_letter(*name))
		id[at++] = 'S';
	for (const char *c = name; *c && at < ID_MOST - 1; c++) {
		bool fits = is_letter(*c) || (*c >= '0' && *c <= '9') ||
		            (*c == '_' && at && id[at - 1] != '_' && c[1]);

		same &= fits && is_letter(*name);
		if (fits || (at && id[at - 1] != '_'))
			id[at++] = fits ? *c : '_';
	}
	id[at] = '\0';
	if (same && at <= most)
		return id;
	if (at > most - ID_PLACE)
		at = most - ID_PLACE;
	snprintf(id + at, ID_MOST - at, "%s%s", at && id[at - 1] == '_' ? "P" : "_P",
	         cells[MODBUS_CELL_place]);
	return id;
}

struct word {
	const char *name, *text;
};

/* The text, with the words that begin with $ replaced; longer names stand before shorter. */
static void put(FILE *out, const char *text, const struct word *words, const struct escape *escape)
{
	while (*text) {
		size_t plain = strcspn(text, "$");
		const struct word *word = words;

		fwrite(text, 1, plain, out);
		text += plain;
		if (!*text)
			return;
		while (word->name && strncmp(text + 1, word->name, strlen(word->name)) != 0)
			word++;
		if (!word->name)
			return;
		text += 1 + strlen(word->name);
		for (const char *c = word->text; *c; c++) {
			const struct escape *e = escape;

			while (e->character && e->character != *c)
				e++;
			fputs(e->character ? e->text : (char[]){*c, '\0'}, out);
		}
	}
}

static void put_once(const struct modbus_file *file, const struct modbus_form *form,
                     const char *text)
{
	char transactions[16];
	const struct word words[] = {{"instance", file->instance},
	                             {"host", file->host},
	                             {"port", file->port},
	                             {"transactions", transactions},
	                             {NULL, NULL}};

	snprintf(transactions, sizeof(transactions), "%u", file->count + 1);
	put(file->out, text, words, form->escape);
}

void modbus_form_begin(struct modbus_file *file, const struct modbus_form *form)
{
	put_once(file, form, form->head);
}

void modbus_form_row(struct modbus_file *file, const struct modbus_form *form,
                     const char *const cells[MODBUS_CELL_COUNT])
{
	unsigned place = (unsigned)strtoul(cells[MODBUS_CELL_place], NULL, 10);
	char id[ID_MOST], numbers[5][16];
	const struct word words[] = {
		{"index", numbers[0]},
		{"place8", numbers[1]},
		{"int16", numbers[2]},
		{"quality", numbers[3]},
		{"y", numbers[4]},
		{"comma", file->written ? ",\n" : ""},
		{"host", file->host},
		{"port", file->port},
#define X(name) {#name, cells[MODBUS_CELL_##name]},
		MODBUS_CELLS(X)
#undef X
			{"id", identifier(cells, file->twin,
	                                  form->id_most ? form->id_most : ID_MOST - 1, id)},
		{NULL, NULL},
	};

	if (!*cells[MODBUS_CELL_name] && !form->removed)
		return;
	snprintf(numbers[0], sizeof(numbers[0]), "%02u", file->written + 1);
	snprintf(numbers[1], sizeof(numbers[1]), "%08u", place);
	snprintf(numbers[2], sizeof(numbers[2]), "%u", layout_in_record(LAYOUT_SHORT, place));
	snprintf(numbers[3], sizeof(numbers[3]), "%u", layout_in_row(LAYOUT_QUALITY, place));
	snprintf(numbers[4], sizeof(numbers[4]), "%u", 60 + 40 * file->written);
	put(file->out, form->row, words, form->escape);
	file->written++;
}

void modbus_form_end(struct modbus_file *file, const struct modbus_form *form)
{
	put_once(file, form, form->foot);
}

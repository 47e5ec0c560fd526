/* dea_drive_run: an instrument that cannot be opened leaves none of the others as it was set up. */
#include "drive/drive.h"
#include "emulator.h"
#include "instrument/line_reader.h"
#include "protocol_text.h"

static void serve(struct emulator *e, int connection)
{
  struct dea_line_reader reader = {0};
  char bytes[512];
  size_t length;
  while ((length = emulator_receive(e, connection, bytes, sizeof bytes)) > 0) {
    const char *at = bytes, *line;
    while ((line = dea_line_next(&reader, &at, &length)) != NULL) {
      if (strchr(line, '?') != NULL) {
        const char *text = strcmp(line, "*OPC?") == 0 ? "1\n"
                           : line[0] == '*'           ? "ACME,Supply\n"
                                                      : "0,\"No error\"\n";
        emulator_send(e, connection, text, strlen(text));
      }
    }
  }
}

TEST(test_stops_what_was_opened)
{
  struct emulator supply = {0};
  struct dea_drive_report report;
  const struct dea_drive_options options = {.file = in_folder("none.h5")};
  char text[2048];
  emulator_start(&supply, serve, NULL);
  snprintf(text, sizeof text,
           "dea-protocol: 1\n" PROTOCOL_AMPLIFIER "waveform: {kind: constant, voltage: 1 kV}\n"
           "instruments:\n"
           "  - {kind: scpi, address: 127.0.0.1, port: %d, output: \"VOLT %%g\", setup: [OUTP ON],"
           " at_stop: [OUTP OFF]}\n"
           "  - {kind: scpi, address: 127.0.0.1, port: %d, readings: "
           "[{name: a, query: \"A?\", quantity: force}]}\n",
           supply.port, emulator_no_port());
  good_protocol(text);
  assert_int_equal(dea_drive_run(ctx, p, &options, &report), DEA_E_INSTRUMENT);
  emulator_stop(&supply);
  assert_non_null(strstr(supply.log, "OUTP ON\n"));
  const char *end = strstr(supply.log, "SYST:ERR?\n");
  assert_non_null(end);
  assert_string_equal(end, "SYST:ERR?\nVOLT 0\n*OPC?\nOUTP OFF\n");
  assert_int_equal(report.zero.state, DEA_ZERO_COMMANDED); // it has no 'measure'
  assert_non_null(strstr(dea_context_message(ctx), "Connection refused"));
}

TESTS(set_up, protocol_tear_down)

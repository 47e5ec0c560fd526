/* Commands and responses of SCPI instruments (SCPI 1999, IEEE 488.2). */
#pragma once

#include <stdbool.h>
#include <stddef.h>

enum { DEA_SCPI_SUFFIX_SIZE = 24, DEA_SCPI_VALUE_SIZE = 96 };

/* The number of a response such as "+1.04E-11", "250 mN" or " 5". field: which of several, between
 * commas or semicolons, from 1 on ("1.2E-9A,+3.1E+2secs"); 0: there must be one alone. NAN for the
 * numbers that SCPI has for infinity, its negative and no number: 9.9E37, -9.9E37 and 9.91E37
 * (larger ones too). false when there is no such field, when it does not begin with a number, or
 * when nobody can tell whether "0,123" is one number with a decimal comma or two. */
bool dea_scpi_number(const char *response, size_t field, double *value);
/* How many fields a response has. */
size_t dea_scpi_fields(const char *response);
/* The number of a response that is a voltage: with a unit behind it that it may have (V, VDC; kV,
 * kVDC), or none. false where anything else stands there, as that could change it by a thousand,
 * and for the numbers that mean none. */
bool dea_scpi_voltage(const char *response, size_t field, bool in_V, bool in_kV, double *value);
/* What stands behind that number in its field, without blanks: a unit, "mN", or a state, "OADC";
 * cut off when it is long. "" when it does not begin with a number. */
void dea_scpi_suffix(const char *response, size_t field, char out[DEA_SCPI_SUFFIX_SIZE]);
/* The number and its unit, "250 mN", as they are read elsewhere: without what says that it is a
 * direct voltage or current (VDC, ADC) or a normal reading (NADC of an electrometer). false: as for
 * the number, and for a unit such as MV, which some write for mV. */
bool dea_scpi_with_unit(const char *response, size_t field, char out[DEA_SCPI_VALUE_SIZE]);
/* An entry of the error queue: -113,"Undefined header". The code, 0 for none; *text: from the comma
 * on, lent. false when it is none. */
bool dea_scpi_error(const char *response, int *code, const char **text);
/* Whether a number can be put in place of the one %g of a command, and nothing around it changes
 * what the number means: no digit, sign or unit beside it, no second command. */
bool dea_scpi_output_is_plain(const char *output);
/* Whether a command gives something other than 0, a number or a word (MAX; not ON or OFF), to what
 * `output` (a plain one) sets: the same text before the number, or the same last mnemonic by its
 * short form of four letters, without [:LEVel][:IMMediate][:AMPLitude]; where words stand between
 * that and the number
 * ("BSWV OFST,%g"), with a number anywhere. So do APPLy with a number, and *RCL. */
bool dea_scpi_sets_output(const char *command, const char *output);
/* Whether a command is about what is measured (CONFigure, SENSe), not about a source. */
bool dea_scpi_configures(const char *command);
/* Whether it has no line's end in it, behind which another command would begin, nor any other
 * control character. */
bool dea_scpi_is_one_line(const char *command);

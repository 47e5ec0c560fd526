#include "import/tdms.h"

#include <math.h>
#include <string.h>

static const uint32_t no_values = 0xffffffff, same_values = 0;
// "format changing scaler" and "digital line scaler"; the second has been seen with both codes
static const uint32_t daqmx_scaler = 0x1269, daqmx_line = 0x126a, daqmx_other_line = 0x1369;

size_t dea_tdms_size(uint32_t type)
{
  switch (type) {
  case DEA_TDMS_I8:
  case DEA_TDMS_U8:
  case DEA_TDMS_BOOL:
    return 1;
  case DEA_TDMS_I16:
  case DEA_TDMS_U16:
    return 2;
  case DEA_TDMS_I32:
  case DEA_TDMS_U32:
  case DEA_TDMS_F32:
  case DEA_TDMS_F32_UNIT:
    return 4;
  case DEA_TDMS_I64:
  case DEA_TDMS_U64:
  case DEA_TDMS_F64:
  case DEA_TDMS_F64_UNIT:
    return 8;
  case DEA_TDMS_TIME:
    return 16;
  default:
    return 0;
  }
}

static uint64_t integer(const unsigned char *at, size_t size, bool big)
{
  uint64_t value = 0;
  for (size_t i = 0; i < size; i++) {
    value = value << 8 | at[big ? i : size - 1 - i];
  }
  return value;
}

/* Takes `size` bytes; NULL when there are less. */
static const unsigned char *read_bytes(struct dea_tdms_bytes *bytes, uint64_t size)
{
  if (bytes->failed || size > (uint64_t)(bytes->end - bytes->next)) {
    bytes->failed = true;
    return NULL;
  }
  const unsigned char *at = bytes->next;
  bytes->next += size;
  return at;
}

uint32_t dea_tdms_u32(struct dea_tdms_bytes *bytes)
{
  const unsigned char *at = read_bytes(bytes, 4);
  return at != NULL ? (uint32_t)integer(at, 4, bytes->big) : 0;
}

uint64_t dea_tdms_u64(struct dea_tdms_bytes *bytes)
{
  const unsigned char *at = read_bytes(bytes, 8);
  return at != NULL ? integer(at, 8, bytes->big) : 0;
}

/* Two's complement of `size` bytes. */
static double signed_value(uint64_t bits, size_t size)
{
  uint64_t sign = (uint64_t)1 << (8 * size - 1);
  if ((bits & sign) == 0) {
    return (double)bits;
  }
  uint64_t mask = size == 8 ? UINT64_MAX : ((uint64_t)1 << (8 * size)) - 1;
  return -(double)((~bits & mask) + 1);
}

double dea_tdms_value(const unsigned char *at, uint32_t type, bool big)
{
  size_t size = dea_tdms_size(type);
  uint64_t bits = size <= 8 ? integer(at, size, big) : 0;
  uint32_t low = (uint32_t)bits;
  float single;
  double real;
  switch (type) {
  case DEA_TDMS_I8:
  case DEA_TDMS_I16:
  case DEA_TDMS_I32:
  case DEA_TDMS_I64:
    return signed_value(bits, size);
  case DEA_TDMS_F32:
  case DEA_TDMS_F32_UNIT:
    memcpy(&single, &low, sizeof single);
    return single;
  case DEA_TDMS_F64:
  case DEA_TDMS_F64_UNIT:
    memcpy(&real, &bits, sizeof real);
    return real;
  case DEA_TDMS_TIME: // fractions of 2^-64 s and seconds, as one number of 128 bits
    real = signed_value(integer(at + (big ? 0 : 8), 8, big), 8);
    return real + ldexp((double)integer(at + (big ? 8 : 0), 8, big), -64);
  default:
    return (double)bits;
  }
}

static struct dea_tdms_text read_text(struct dea_tdms_bytes *bytes)
{
  uint32_t length = dea_tdms_u32(bytes);
  const unsigned char *at = read_bytes(bytes, length);
  return (struct dea_tdms_text){at != NULL ? (const char *)at : "", at != NULL ? length : 0};
}

static dea_status refuse(struct dea_tdms *tdms, const struct dea_tdms_bytes *bytes,
                         const char *what)
{
  return dea_fail(tdms->ctx, DEA_E_IO, "'%s' is damaged at byte %zu: %s", tdms->file,
                  (size_t)(bytes->next - bytes->start), what);
}

static bool same(struct dea_tdms_text a, const char *b)
{
  return a.length == strlen(b) && memcmp(a.text, b, a.length) == 0;
}

/* The object of a path, added when it is new; *out its index. */
static dea_status find_object(struct dea_tdms *tdms, struct dea_tdms_text path, size_t *out)
{
  for (*out = 0; *out < tdms->count; ++*out) {
    const struct dea_tdms_text *other = &tdms->objects[*out].path;
    if (other->length == path.length && memcmp(other->text, path.text, path.length) == 0) {
      return DEA_OK;
    }
  }
  if (tdms->count == DEA_TDMS_OBJECTS_MAX) {
    return dea_fail(tdms->ctx, DEA_E_IO, "'%s' has more than %d channels", tdms->file,
                    (int)DEA_TDMS_OBJECTS_MAX);
  }
  if (tdms->count == tdms->capacity) {
    size_t capacity = 2 * tdms->capacity + 16;
    void *moved = dea_resize(tdms->ctx, tdms->objects, capacity, sizeof *tdms->objects);
    DEA_TRY_MEMORY(moved != NULL);
    tdms->objects = moved;
    tdms->capacity = capacity;
  }
  tdms->objects[tdms->count++] = (struct dea_tdms_object){.path = path,
                                                          .unit = {"", 0},
                                                          .increment = NAN,
                                                          .start_time = NAN,
                                                          .slope = NAN,
                                                          .intercept = 0};
  return DEA_OK;
}

/* Puts an object among those with values in this segment, once. */
static dea_status add_to_order(struct dea_tdms *tdms, size_t object)
{
  if (tdms->objects[object].in_segment) {
    return DEA_OK;
  }
  if (tdms->order_count == tdms->order_room) {
    size_t capacity = 2 * tdms->order_room + 16;
    void *moved = dea_resize(tdms->ctx, tdms->order, capacity, sizeof *tdms->order);
    DEA_TRY_MEMORY(moved != NULL);
    tdms->order = moved;
    tdms->order_room = capacity;
  }
  tdms->objects[object].in_segment = true;
  tdms->order[tdms->order_count++] = object;
  return DEA_OK;
}

static void read_from_order(struct dea_tdms *tdms, size_t object)
{
  size_t kept = 0;
  for (size_t i = 0; i < tdms->order_count; i++) {
    if (tdms->order[i] != object) {
      tdms->order[kept++] = tdms->order[i];
    }
  }
  tdms->order_count = kept;
  tdms->objects[object].in_segment = false;
}

/* Type and number of an object's values in this segment. */
static dea_status read_index(struct dea_tdms *tdms, struct dea_tdms_bytes *bytes, size_t index,
                             uint32_t length)
{
  struct dea_tdms_object *object = &tdms->objects[index];
  if (length == no_values) {
    read_from_order(tdms, index);
    return DEA_OK;
  }
  if (length == daqmx_scaler || length == daqmx_line || length == daqmx_other_line) {
    return dea_fail(tdms->ctx, DEA_E_IO,
                    "'%s' holds DAQmx raw data: open it in LabVIEW or DIAdem and save it as TDMS "
                    "with scaled values, or as CSV",
                    tdms->file);
  }
  if (length == same_values) {
    return object->type != 0 ? add_to_order(tdms, index)
                             : refuse(tdms, bytes, "values 'as before' of a new channel");
  }
  uint32_t type = dea_tdms_u32(bytes), dimension = dea_tdms_u32(bytes);
  uint64_t values = dea_tdms_u64(bytes);
  size_t size = dea_tdms_size(type);
  uint64_t total = type == DEA_TDMS_TEXT ? dea_tdms_u64(bytes) : 0;
  if (bytes->failed) {
    return DEA_OK;
  }
  if (dimension != 1) {
    return refuse(tdms, bytes, "a channel of more than one dimension");
  }
  if (size == 0 && type != DEA_TDMS_TEXT) {
    return dea_fail(tdms->ctx, DEA_E_IO,
                    "'%s': the channel %.*s has values of type 0x%x, which are not read",
                    tdms->file, (int)(object->path.length < 80 ? object->path.length : 80),
                    object->path.text, type);
  }
  if (object->type != 0 && object->type != type) {
    return refuse(tdms, bytes, "the type of a channel changes");
  }
  // what is larger than the file cannot be there
  if ((size > 0 && values > bytes->file_size / size) || total > bytes->file_size) {
    return refuse(tdms, bytes, "a channel has more values than the file has bytes");
  }
  object->type = type;
  object->values = values;
  object->bytes = size > 0 ? values * size : total;
  return add_to_order(tdms, index);
}

bool dea_tdms_is_linear(const struct dea_tdms_object *object)
{
  return !object->applied && object->scales == 1 && object->linear && isfinite(object->slope) &&
         isfinite(object->intercept);
}

/* What NI writes of the scale of raw values. */
static void read_scale(struct dea_tdms_object *object, struct dea_tdms_text name,
                       struct dea_tdms_text text, double value)
{
  if (same(name, "NI_Number_Of_Scales") && value > 0) {
    object->scales = value;
  } else if (same(name, "NI_Scaling_Status")) {
    object->applied = same(text, "scaled");
  } else if (same(name, "NI_Scale[0]_Scale_Type")) {
    object->linear = same(text, "Linear");
  } else if (same(name, "NI_Scale[0]_Linear_Slope")) {
    object->slope = value;
  } else if (same(name, "NI_Scale[0]_Linear_Y_Intercept")) {
    object->intercept = value;
  }
}

static void read_property(struct dea_tdms_bytes *bytes, struct dea_tdms_object *object)
{
  struct dea_tdms_text name = read_text(bytes), text = {"", 0};
  uint32_t type = dea_tdms_u32(bytes);
  double value = NAN;
  if (type == DEA_TDMS_TEXT) {
    text = read_text(bytes);
  } else {
    size_t size = dea_tdms_size(type);
    const unsigned char *at = size > 0 ? read_bytes(bytes, size) : NULL;
    value = at != NULL ? dea_tdms_value(at, type, bytes->big) : NAN;
    bytes->failed = bytes->failed || at == NULL;
  }
  if (same(name, "wf_increment") && value > 0) {
    object->increment = value;
  } else if (same(name, "wf_start_time") && value > 0 && isnan(object->start_time)) {
    object->start_time = value; // of its first values: what is appended may write it again
  } else if (same(name, "wf_start_offset") && isfinite(value)) {
    object->start_offset = value;
  } else if ((same(name, "unit_string") || same(name, "NI_UnitDescription")) && text.length > 0) {
    object->unit = text;
  } else {
    read_scale(object, name, text, value);
  }
}

dea_status dea_tdms_metadata(struct dea_tdms *tdms, struct dea_tdms_bytes *bytes, bool new_list)
{
  if (new_list) {
    for (size_t i = 0; i < tdms->order_count; i++) {
      tdms->objects[tdms->order[i]].in_segment = false;
    }
    tdms->order_count = 0;
  }
  uint32_t count = dea_tdms_u32(bytes);
  for (uint32_t i = 0; i < count && !bytes->failed; i++) {
    struct dea_tdms_text path = read_text(bytes);
    uint32_t length = dea_tdms_u32(bytes);
    size_t index;
    if (bytes->failed) {
      break;
    }
    DEA_TRY(tdms->ctx, find_object(tdms, path, &index));
    DEA_TRY(tdms->ctx, read_index(tdms, bytes, index, length));
    uint32_t properties = dea_tdms_u32(bytes);
    for (uint32_t k = 0; k < properties && !bytes->failed; k++) {
      read_property(bytes, &tdms->objects[index]);
    }
  }
  return bytes->failed ? refuse(tdms, bytes,
                                "its metadata end early, or hold a property of an "
                                "unknown type")
                       : DEA_OK;
}

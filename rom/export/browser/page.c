/* What the page needs besides fingerfem_model_... and control_standalone_... */
#include <stdint.h>
#include "../../../control/native/standalone.h"

int32_t page_finger_size(void) { return (int32_t)sizeof(control_finger); }

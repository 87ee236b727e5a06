#include "radiosity/shaft.h"

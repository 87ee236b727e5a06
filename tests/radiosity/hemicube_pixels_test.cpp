#include "radiosity/hemicube_pixels.h"

#include "render/image/color_config.h"

namespace twopass {

// ACES2065-1 is the reference space because the built-in ACES views start there; the detour costs Rec.709
// nothing, since the matrices there and back multiply to one. Names and aliases are those of the ASWF
// configurations.
std::string_view builtin_ocio_config() {
  return R"(ocio_profile_version: 2
name: twopass-built-in
description: Linear Rec.709 in, sRGB or Rec.1886 out, plain or through the ACES 1.0 SDR view.
strictparsing: true
luma: [0.2126, 0.7152, 0.0722]

roles:
  aces_interchange: ACES2065-1
  cie_xyz_d65_interchange: CIE-XYZ-D65
  color_picking: sRGB - Texture
  data: Raw
  default: Linear Rec.709 (sRGB)
  reference: ACES2065-1
  rendering: Linear Rec.709 (sRGB)
  scene_linear: Linear Rec.709 (sRGB)
  texture_paint: sRGB - Texture

file_rules:
  - !<Rule> {name: Default, colorspace: default}

shared_views:
  - !<View> {name: Un-tone-mapped, view_transform: Un-tone-mapped, display_colorspace: <USE_DISPLAY_NAME>}
  - !<View> {name: ACES 1.0 - SDR Video, view_transform: ACES 1.0 - SDR Video, display_colorspace: <USE_DISPLAY_NAME>}

displays:
  sRGB - Display:
    - !<Views> [Un-tone-mapped, ACES 1.0 - SDR Video]
    - !<View> {name: Raw, colorspace: Raw}
  Rec.1886 Rec.709 - Display:
    - !<Views> [Un-tone-mapped, ACES 1.0 - SDR Video]
    - !<View> {name: Raw, colorspace: Raw}

active_displays: [sRGB - Display, Rec.1886 Rec.709 - Display]
active_views: [Un-tone-mapped, ACES 1.0 - SDR Video, Raw]

default_view_transform: Un-tone-mapped

view_transforms:
  - !<ViewTransform>
    name: Un-tone-mapped
    from_scene_reference: !<BuiltinTransform> {style: UTILITY - ACES-AP0_to_CIE-XYZ-D65_BFD}
  - !<ViewTransform>
    name: ACES 1.0 - SDR Video
    from_scene_reference: !<BuiltinTransform> {style: ACES-OUTPUT - ACES2065-1_to_CIE-XYZ-D65 - SDR-VIDEO_1.0}

display_colorspaces:
  - !<ColorSpace>
    name: CIE-XYZ-D65
    encoding: display-linear
  - !<ColorSpace>
    name: sRGB - Display
    aliases: [srgb_display]
    encoding: sdr-video
    from_display_reference: !<BuiltinTransform> {style: DISPLAY - CIE-XYZ-D65_to_sRGB}
  - !<ColorSpace>
    name: Rec.1886 Rec.709 - Display
    aliases: [rec1886_rec709_display]
    encoding: sdr-video
    from_display_reference: !<BuiltinTransform> {style: DISPLAY - CIE-XYZ-D65_to_REC.1886-REC.709}

colorspaces:
  - !<ColorSpace>
    name: ACES2065-1
    aliases: [lin_ap0_scene]
    encoding: scene-linear
  - !<ColorSpace>
    name: Linear Rec.709 (sRGB)
    aliases: [lin_rec709_scene, lin_rec709_srgb]
    encoding: scene-linear
    to_scene_reference: !<GroupTransform>
      children:
        - !<BuiltinTransform> {style: UTILITY - ACES-AP1_to_LINEAR-REC709_BFD, direction: inverse}
        - !<BuiltinTransform> {style: ACEScg_to_ACES2065-1}
  - !<ColorSpace>
    name: ACEScg
    aliases: [lin_ap1_scene]
    encoding: scene-linear
    to_scene_reference: !<BuiltinTransform> {style: ACEScg_to_ACES2065-1}
  - !<ColorSpace>
    name: sRGB - Texture
    aliases: [srgb_rec709_scene]
    encoding: sdr-video
    to_scene_reference: !<GroupTransform>
      children:
        - !<ExponentWithLinearTransform> {gamma: 2.4, offset: 0.055}
        - !<BuiltinTransform> {style: UTILITY - ACES-AP1_to_LINEAR-REC709_BFD, direction: inverse}
        - !<BuiltinTransform> {style: ACEScg_to_ACES2065-1}
  - !<ColorSpace>
    name: Raw
    isdata: true
)";
}

}  // namespace twopass

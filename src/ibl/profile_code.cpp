#include "ibl/profile_code.h"

#include <algorithm>
#include <array>

#include "base/check.h"

namespace candela::ibl {

namespace {

struct EngineCode {
  std::string_view profile, loading, panorama;
};

// By the documentation of each engine; docs/ibl-profiles.md says which were run.
constexpr auto kCodes = std::to_array<EngineCode>({
    {"filament", R"(// C++; bytes is the content of specular.ktx
auto* bundle = new image::Ktx1Bundle(bytes.data(), bytes.size());
filament::math::float3 sh[9];
bundle->getSphericalHarmonics(sh);
auto* cube = ktxreader::Ktx1Reader::createTexture(engine, bundle, false);
auto* light = IndirectLight::Builder().reflections(cube).irradiance(3, sh).intensity(30000).build(*engine);
scene->setIndirectLight(light);
scene->setSkybox(Skybox::Builder().environment(cube).build(*engine));
)",
     ""},
    {"three", R"(// JavaScript
import { HDRCubeTextureLoader } from 'three/addons/loaders/HDRCubeTextureLoader.js';
const faces = ['px', 'nx', 'py', 'ny', 'pz', 'nz'].map((face) => `specular_${face}.hdr`);
const cube = await new HDRCubeTextureLoader().loadAsync(faces);
scene.environment = cube;
scene.background = cube;
)",
     R"(import { HDRLoader } from 'three/addons/loaders/HDRLoader.js'; // RGBELoader before r180
const panorama = await new HDRLoader().loadAsync('street.hdr');
panorama.mapping = THREE.EquirectangularReflectionMapping;
scene.environment = panorama;
)"},
    {"babylon", R"(// JavaScript
const cube = BABYLON.CubeTexture.CreateFromPrefilteredData('specular.dds', scene);
const { coefficients } = await (await fetch('sh.json')).json();
cube.sphericalPolynomial = BABYLON.SphericalPolynomial.FromArray(coefficients);
scene.environmentTexture = cube;
scene.createDefaultSkybox(cube, true, 1000);
)",
     R"(scene.environmentTexture = new BABYLON.HDRCubeTexture('street.hdr', scene, 256);
)"},
    {"khronos",
     R"(// GLSL, as the renderer's ibl.glsl; uGGX is specular.ktx2, uLambert is diffuse.ktx2, uTable is dfg.ktx2 (--tables)
vec3 specular = textureLod(uGGX, reflect(-v, n), roughness * float(textureQueryLevels(uGGX) - 1)).rgb;
vec2 table = texture(uTable, vec2(dot(n, v), roughness)).rg;
vec3 diffuse = texture(uLambert, n).rgb;
color = specular * (f0 * table.x + table.y) + diffuse * albedo;
)",
     ""},
    {"bevy", R"(// Rust; the files lie in assets/
commands.spawn((
    Camera3d::default(),
    EnvironmentMapLight {
        diffuse_map: asset_server.load("diffuse.ktx2"),
        specular_map: asset_server.load("specular.ktx2"),
        intensity: 1000.0,
        ..default()
    },
));
)",
     ""},
    {"godot", R"(# GDScript; the file lies in the project's folder
var material := PanoramaSkyMaterial.new()
material.panorama = load("res://environment.exr")
var sky := Sky.new()
sky.sky_material = material
$WorldEnvironment.environment.sky = sky
$WorldEnvironment.environment.background_mode = Environment.BG_SKY
)",
     R"(material.panorama = load("res://street.hdr")  # a quarter turn away from what Candela shows
)"},
    {"unreal", R"(# Python, in the editor, after specular.dds was imported into /Game
actor = unreal.EditorLevelLibrary.spawn_actor_from_class(unreal.SkyLight, unreal.Vector())
light = actor.get_component_by_class(unreal.SkyLightComponent)
light.set_editor_property("source_type", unreal.SkyLightSourceType.SLS_SPECIFIED_CUBEMAP)
light.set_editor_property("cubemap", unreal.load_asset("/Game/specular"))
light.recapture_sky()
)",
     R"(# An imported street.hdr is a texture cube, too.
)"},
    {"unity", R"(// C#; specular.dds lies in Assets/Resources
RenderSettings.defaultReflectionMode = UnityEngine.Rendering.DefaultReflectionMode.Custom;
RenderSettings.customReflectionTexture = Resources.Load<Cubemap>("specular");
)",
     R"(// An imported street.hdr of texture shape Cube with specular convolution, in the same place.
)"},
});

const EngineCode& code_of(const Profile& profile) {
  const auto* found =
      std::find_if(kCodes.begin(), kCodes.end(), [&](const EngineCode& c) { return c.profile == profile.name; });
  CANDELA_CHECK(found != kCodes.end());
  return *found;
}

}  // namespace

std::string_view loading_code(const Profile& profile) { return code_of(profile).loading; }
std::string_view panorama_code(const Profile& profile) { return code_of(profile).panorama; }

}  // namespace candela::ibl

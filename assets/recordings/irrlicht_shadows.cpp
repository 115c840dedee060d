// A small scene with Irrlicht: a floor, two casters, stencil shadows that darken what is drawn.
//
//     g++ irrlicht_shadows.cpp -lIrrlicht -o irrlicht_shadows
//     xvfb-run -a stencilscope record -o DIR -- ./irrlicht_shadows [OPTION…]
//
//     --z-pass           volumes are counted in front of what is seen, not behind it
//     --inside           the eye stands in a shadow, and the ball is not there: of its volume, z-fail draws no whole cap
//     --reach D          volumes are so long
//     --say FILE         also writes to FILE what is printed
//
// Prints where light and camera are, for tests: `light X Y Z W`, and `camera` with eye, target, up and the vertical field of
// view in degrees. Irrlicht's z points away from the eye: what is printed has it the other way round, as OpenGL does.
//
// Irrlicht draws with OpenGL of the compatibility profile, which is recorded on Mesa's zink (Debian: mesa-vulkan-drivers).
//
// Debian: libirrlicht-dev. Every mesh is made here.

#include <irrlicht/irrlicht.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <initializer_list>

using irr::core::vector3df;

static void say(FILE* to, const vector3df& light, const irr::scene::ICameraSceneNode& camera) {
    const vector3df eye = camera.getPosition(), target = camera.getTarget(), up = camera.getUpVector();
    const double degrees = camera.getFOV() * 180 / irr::core::PI64;
    fprintf(to, "version %s\nlight %g %g %g 1\ncamera", IRRLICHT_SDK_VERSION, light.X, light.Y, -light.Z);
    for (const vector3df& place : {eye, target, up}) fprintf(to, " %g %g %g", place.X, place.Y, -place.Z);
    fprintf(to, " %.9g\n", degrees);
    fflush(to);
}

int main(int count, char** words) {
    bool z_fail = true, is_inside = false;
    float reach = 1000;
    const char* file = nullptr;
    for (int at = 1; at < count; ++at) {
        const bool has_value = at + 1 < count;
        if (!strcmp(words[at], "--z-pass")) z_fail = false;
        else if (!strcmp(words[at], "--inside")) is_inside = true;
        else if (!strcmp(words[at], "--reach") && has_value) reach = float(atof(words[++at]));
        else if (!strcmp(words[at], "--say") && has_value) file = words[++at];
        else return fprintf(stderr, "unknown: %s\n", words[at]), 2;
    }

    irr::SIrrlichtCreationParameters parameters;
    parameters.DriverType = irr::video::EDT_OPENGL;
    parameters.WindowSize = irr::core::dimension2du(320, 240);
    parameters.Stencilbuffer = true;
    parameters.AntiAlias = 0;
    parameters.Bits = 32;
    irr::IrrlichtDevice* device = irr::createDeviceEx(parameters);
    if (!device) return 1;
    irr::scene::ISceneManager* scene = device->getSceneManager();
    const auto casts = [&](irr::scene::IMeshSceneNode* node) {
        node->addShadowVolumeSceneNode(nullptr, -1, z_fail, reach);
    };
    const irr::core::dimension2df cell(10, 10);
    const irr::core::dimension2du cells(20, 20);
    scene->addMeshSceneNode(scene->getGeometryCreator()->createPlaneMesh(cell, cells));
    if (!is_inside) casts(scene->addSphereSceneNode(8, 24, nullptr, -1, vector3df(0, 14, 0)));
    casts(scene->addCubeSceneNode(12, nullptr, -1, vector3df(-25, 12, 15), vector3df(20, 30, 10)));
    const vector3df light(40, 70, -30);
    vector3df eye(0, 55, -75), target(-5, 5, 0);
    if (is_inside) {
        // Behind a large block that stands between the light and the eye.
        eye = vector3df(-50, 20, 45);
        target = vector3df(0, 5, 0);
        const vector3df between = eye + (light - eye) * 0.35f;
        casts(scene->addCubeSceneNode(20, nullptr, -1, between, vector3df(0, 30, 0)));
    }
    scene->addLightSceneNode(nullptr, light, irr::video::SColorf(1, 1, 1), 400);
    scene->setAmbientLight(irr::video::SColorf(0.2f, 0.2f, 0.2f));
    scene->setShadowColor(irr::video::SColor(150, 0, 0, 0));
    irr::scene::ICameraSceneNode* camera = scene->addCameraSceneNode(nullptr, eye, target);
    camera->setFarValue(2000);

    say(stdout, light, *camera);
    if (FILE* to = file ? fopen(file, "w") : nullptr) {
        say(to, light, *camera);
        fclose(to);
    }
    irr::video::IVideoDriver* driver = device->getVideoDriver();
    while (device->run()) {
        driver->beginScene(true, true, irr::video::SColor(255, 90, 110, 150));
        scene->drawAll();
        driver->endScene();
    }
    device->drop();
}

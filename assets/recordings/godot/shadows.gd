extends SceneTree

# A small scene with Godot 3: a floor, three casters, one light and its shadow map.
#
#     xvfb-run -a stencilscope record --list -- godot3 --path assets/recordings/godot -s shadows.gd [OPTION…]
#
#     --light KIND       spot (default), directional or point
#     --splits N         of a directional light's view: 1, 2 or 4 parts of one texture
#     --reach D          how far from the eye a directional light has shadows
#     --normal-bias F    by how much a directional light's vertices are moved away from it, those beside its middle more
#     --bias F           by how much all vertices are moved away from the light
#     --paraboloids      a point light's map is drawn as two paraboloids, not as a cube that is brought into them
#     --texels N         the width and height of the texture that maps of spot and point lights are parts of
#     --left-out         the ball casts no shadow
#     --open             a fourth caster: a rectangle that faces away from the light, whose back is seen by nobody
#     --still            the map is drawn once: what is recorded only reads it
#     --say FILE         also writes to FILE what is printed
#
# Prints where light and camera are, for tests: `light X Y Z W`, and `camera` with eye, target, up and the vertical field
# of view in degrees.
#
# Debian: godot3. It runs this itself, as RenderDoc does not follow what another script starts.

const LAMP = Vector3(4, 8, 4)
const EYE = Vector3(5, 6, 9)
const TARGET = Vector3(0, 0.5, 0)
const UP = Vector3(0, 1, 0)
const DEGREES = 35

var light


func is_given(name):
	return name in OS.get_cmdline_args()


func option(name, otherwise):
	var words = OS.get_cmdline_args()
	var at = Array(words).find(name)
	return words[at + 1] if at >= 0 else str(otherwise)


func add(mesh, place):
	var instance = MeshInstance.new()
	instance.mesh = mesh
	get_root().add_child(instance)
	instance.translation = place
	return instance


func add_casters():
	var ground = PlaneMesh.new()
	ground.size = Vector2(20, 20)
	add(ground, Vector3())
	var ball = SphereMesh.new()
	ball.radial_segments = 32
	ball.rings = 16
	if is_given("--left-out"):
		add(ball, Vector3(0, 1.5, 0)).cast_shadow = GeometryInstance.SHADOW_CASTING_SETTING_OFF
	else:
		add(ball, Vector3(0, 1.5, 0))
	var box = CubeMesh.new()
	box.size = Vector3(1, 1, 1)
	add(box, Vector3(2, 0.7, -1))
	var post = CylinderMesh.new()
	post.top_radius = 0.3
	post.bottom_radius = 0.5
	add(post, Vector3(-2, 1, 0))
	if is_given("--open"):
		var rectangle = QuadMesh.new()
		rectangle.size = Vector2(1.5, 1.5)
		add(rectangle, Vector3(-1.5, 1, 2)).look_at(Vector3(-1.5, 1, 2) + LAMP, UP)


func add_light(kind):
	match kind:
		"directional":
			light = DirectionalLight.new()
			light.directional_shadow_mode = {"1": 0, "2": 1, "4": 2}[option("--splits", 1)]
			light.directional_shadow_max_distance = float(option("--reach", 40))
			light.directional_shadow_normal_bias = float(option("--normal-bias", light.directional_shadow_normal_bias))
		"spot":
			light = SpotLight.new()
			light.spot_range = 20
			light.spot_angle = 40
		"point":
			light = OmniLight.new()
			light.omni_range = 20
			if is_given("--paraboloids"):
				light.omni_shadow_mode = OmniLight.SHADOW_DUAL_PARABOLOID
	light.shadow_bias = float(option("--bias", light.shadow_bias))
	light.light_energy = 2
	light.shadow_enabled = true
	get_root().add_child(light)
	light.look_at_from_position(LAMP, Vector3(), UP)


func add_camera():
	var camera = Camera.new()
	get_root().add_child(camera)
	camera.fov = DEGREES
	camera.look_at_from_position(EYE, TARGET, UP)
	camera.current = true


func words(places):
	var found = PoolStringArray()
	for place in places:
		found.append("%s %s %s" % [place.x, place.y, place.z])
	return found.join(" ")


func _initialize():
	var kind = option("--light", "spot")
	get_root().shadow_atlas_size = int(option("--texels", 4096))
	add_casters()
	add_light(kind)
	add_camera()
	var version = Engine.get_version_info()
	var said = "version %d.%d.%d\n" % [version.major, version.minor, version.patch]
	said += "light %s %d\n" % [words([LAMP]), 0 if kind == "directional" else 1]
	said += "camera %s %s\n" % [words([EYE, TARGET, UP]), DEGREES]
	print(said)
	var path = option("--say", "")
	if path != "":
		var file = File.new()
		file.open(path, File.WRITE)
		file.store_string(said)
		file.close()


func _idle(_delta):
	# Godot draws a map anew only when something has changed.
	if not is_given("--still"):
		light.shadow_bias = light.shadow_bias

// Walks through a radiosity solution: the display mesh of `twopass solve` (binary glTF, in base64, with linear colours at its
// vertices), drawn as it is, without lights.
'use strict';

(function () {
  const byId = (id) => document.getElementById(id);
  const canvas = byId('view');

  // The JSON and the binary chunk of a .glb.
  function parseGlb(buffer) {
    const view = new DataView(buffer);
    const jsonSize = view.getUint32(12, true);
    const json = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 20, jsonSize)));
    const binary = 20 + jsonSize + 8;
    return { json, binary: binary <= buffer.byteLength ? buffer.slice(binary) : new ArrayBuffer(0) };
  }

  function decodeBase64(text) {
    const raw = atob(text.trim());
    const bytes = new Uint8Array(raw.length);
    for (let i = 0; i < raw.length; ++i) bytes[i] = raw.charCodeAt(i);
    return bytes.buffer;
  }

  function numbersOf(glb, index) {
    const accessor = glb.json.accessors[index];
    const begin = glb.json.bufferViews[accessor.bufferView].byteOffset + accessor.byteOffset;
    return accessor.type === 'SCALAR'
      ? new Uint32Array(glb.binary, begin, accessor.count)
      : new Float32Array(glb.binary, begin, 3 * accessor.count);
  }

  // Positions are taken relative to the middle of the model: the graphics card has few digits.
  function geometriesOf(glb, middle) {
    const geometries = [];
    for (const mesh of glb.json.meshes || [])
      for (const primitive of mesh.primitives) {
        const position = numbersOf(glb, primitive.attributes.POSITION).slice();
        for (let i = 0; i < position.length; ++i) position[i] -= middle.getComponent(i % 3);
        const geometry = new THREE.BufferGeometry();
        geometry.setAttribute('position', new THREE.BufferAttribute(position, 3));
        geometry.setAttribute('color', new THREE.BufferAttribute(numbersOf(glb, primitive.attributes.COLOR_0), 3));
        geometry.setIndex(new THREE.BufferAttribute(numbersOf(glb, primitive.indices), 1));
        geometries.push(geometry);
      }
    return geometries;
  }

  function boxOf(glb) {
    const box = new THREE.Box3();
    for (const mesh of glb.json.meshes || [])
      for (const primitive of mesh.primitives) {
        const accessor = glb.json.accessors[primitive.attributes.POSITION];
        box.expandByPoint(new THREE.Vector3().fromArray(accessor.min));
        box.expandByPoint(new THREE.Vector3().fromArray(accessor.max));
      }
    return box;
  }

  // Colours are linear; what leaves is encoded for sRGB displays.
  function materialOf(wireframe) {
    return new THREE.ShaderMaterial({
      uniforms: { exposure: { value: 1 } },
      vertexColors: THREE.VertexColors,
      wireframe,
      vertexShader: `
        varying vec3 shown;
        void main() {
          shown = color;
          gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
        }`,
      fragmentShader: `
        uniform float exposure;
        varying vec3 shown;
        void main() {
          vec3 c = clamp(shown * exposure, 0.0, 1.0);
          vec3 encoded = mix(1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, 12.92 * c, vec3(lessThanEqual(c, vec3(0.0031308))));
          gl_FragColor = vec4(encoded, 1.0);
        }`,
    });
  }

  // Where the scene's camera stands, else at three quarters outside.
  function startOf(glb, box, middle) {
    const node = (glb.json.nodes || []).find((n) => n.camera !== undefined);
    if (node) {
      const matrix = new THREE.Matrix4().fromArray(node.matrix);
      const position = new THREE.Vector3().setFromMatrixPosition(matrix).sub(middle);
      const forward = new THREE.Vector3(0, 0, -1).transformDirection(matrix);
      const up = new THREE.Vector3(0, 1, 0).transformDirection(matrix);
      return { position, forward, up, fov: glb.json.cameras[node.camera].perspective.yfov };
    }
    const size = box.getSize(new THREE.Vector3());
    const offset = new THREE.Vector3(0.6, 0.45, 1).normalize().multiplyScalar(1.3 * size.length());
    return { position: offset, forward: offset.clone().negate().normalize(), up: new THREE.Vector3(0, 1, 0), fov: Math.PI / 4 };
  }

  // The axis of the world that is up: the one that the start's up leans to.
  function worldUpOf(up) {
    const axes = [new THREE.Vector3(1, 0, 0), new THREE.Vector3(0, 1, 0), new THREE.Vector3(0, 0, 1)];
    const best = axes.reduce((a, b) => (Math.abs(b.dot(up)) > Math.abs(a.dot(up)) ? b : a));
    return best.clone().multiplyScalar(Math.sign(best.dot(up)) || 1);
  }

  function walk() {
    const glb = parseGlb(decodeBase64(byId('model').textContent));
    const box = boxOf(glb);
    const middle = box.isEmpty() ? new THREE.Vector3() : box.getCenter(new THREE.Vector3());
    const length = box.isEmpty() ? 1 : box.getSize(new THREE.Vector3()).length();
    const renderer = new THREE.WebGLRenderer({ canvas, antialias: true, preserveDrawingBuffer: true });
    const bare = location.hash === '#bare';  // the model alone, for pictures
    renderer.setClearColor(bare ? 0x000000 : 0x111111);
    const scene = new THREE.Scene();
    const solid = materialOf(false), wire = materialOf(true);
    const meshes = geometriesOf(glb, middle).map((geometry) => new THREE.Mesh(geometry, solid));
    meshes.forEach((mesh) => scene.add(mesh));

    const start = startOf(glb, box, middle);
    const worldUp = worldUpOf(start.up);
    const camera = new THREE.PerspectiveCamera((start.fov * 180) / Math.PI, 1, length * 1e-3, length * 20);
    camera.up.copy(worldUp);
    const forward = new THREE.Vector3();
    let dirty = true;

    function reset() {
      camera.position.copy(start.position);
      forward.copy(start.forward);
      dirty = true;
    }

    // Turns the view by angles in radians, never past straight up or down.
    function turn(left, up) {
      forward.applyAxisAngle(worldUp, left);
      const right = new THREE.Vector3().crossVectors(forward, worldUp).normalize();
      const turned = forward.clone().applyAxisAngle(right, up);
      if (Math.abs(turned.dot(worldUp)) < 0.995) forward.copy(turned);
      forward.normalize();
      dirty = true;
    }

    function move(ahead, right, up) {
      const side = new THREE.Vector3().crossVectors(forward, worldUp).normalize();
      camera.position.addScaledVector(forward, ahead).addScaledVector(side, right).addScaledVector(worldUp, up);
      dirty = true;
    }

    const held = new Set();
    let hurry = 1;
    const step = { KeyW: [1, 0, 0], ArrowUp: [1, 0, 0], KeyS: [-1, 0, 0], ArrowDown: [-1, 0, 0], KeyD: [0, 1, 0], ArrowRight: [0, 1, 0],
      KeyA: [0, -1, 0], ArrowLeft: [0, -1, 0], KeyE: [0, 0, 1], KeyQ: [0, 0, -1] };
    const typing = (event) => event.target instanceof HTMLInputElement && event.target.type === 'range';
    document.addEventListener('keydown', (event) => {
      if (event.ctrlKey || event.metaKey || event.altKey || typing(event)) return;
      hurry = event.shiftKey ? 4 : 1;
      if (event.code === 'KeyR') reset();
      else if (event.code === 'KeyH') byId('panel').classList.toggle('hidden');
      else if (event.code === 'KeyT') byId('elements').click();
      else if (event.code in step) held.add(event.code);
      else return;
      event.preventDefault();
    });
    document.addEventListener('keyup', (event) => {
      held.delete(event.code);
      hurry = event.shiftKey ? 4 : 1;
    });
    window.addEventListener('blur', () => held.clear());
    canvas.addEventListener('pointerdown', (event) => canvas.setPointerCapture(event.pointerId));
    canvas.addEventListener('pointermove', (event) => {
      if (event.buttons & 1) turn(event.movementX * 0.004, event.movementY * 0.004);
    });
    canvas.addEventListener('wheel', (event) => {
      move(-Math.sign(event.deltaY) * 0.03 * length, 0, 0);
      event.preventDefault();
    }, { passive: false });
    byId('reset').addEventListener('click', reset);
    byId('exposure').addEventListener('input', (event) => {
      solid.uniforms.exposure.value = wire.uniforms.exposure.value = Math.pow(2, event.target.value);
      byId('stops').textContent = Number(event.target.value).toFixed(1);
      dirty = true;
    });
    byId('elements').addEventListener('change', (event) => {
      meshes.forEach((mesh) => { mesh.material = event.target.checked ? wire : solid; });
      dirty = true;
    });

    function resize() {
      renderer.setPixelRatio(window.devicePixelRatio);
      renderer.setSize(window.innerWidth, window.innerHeight, false);
      camera.aspect = window.innerWidth / window.innerHeight;
      camera.updateProjectionMatrix();
      dirty = true;
    }
    window.addEventListener('resize', resize);

    let last = performance.now();
    function frame(now) {
      const seconds = Math.min((now - last) / 1000, 0.1);
      last = now;
      const speed = 0.2 * length * hurry * Math.pow(2, byId('speed').value) * seconds;
      held.forEach((code) => move(...step[code].map((part) => part * speed)));
      if (dirty) {
        camera.lookAt(new THREE.Vector3().addVectors(camera.position, forward));
        renderer.render(scene, camera);
        dirty = false;
      }
      requestAnimationFrame(frame);
    }
    byId('panel').classList.toggle('hidden', bare);
    reset();
    resize();
    requestAnimationFrame(frame);
    document.body.dataset.triangles = meshes.reduce((sum, mesh) => sum + mesh.geometry.index.count / 3, 0);
  }

  try {
    walk();
  } catch (error) {
    byId('trouble').textContent = 'The model cannot be shown: ' + error.message + '. The browser may lack WebGL.';
  }
})();

// SPDX-License-Identifier: Apache-2.0
// Draws points as a closed, smoothly shaded surface: Botsch, Hornung, Zwicker, Kobbelt, "High-Quality Surface Splatting on Today's GPUs",
// PBG 2005. Visibility of the tilted discs, blending of what lies near the visible surface, shading of every pixel.

import * as THREE from "three";
import { ColourTextures, makeColourUniforms } from "./colour_texture";
import { dropFloatTarget, makeFloatTarget } from "./float_target";
import { hidingExtent, slimness } from "./disc_shaders";
import { makePointUniforms } from "./points_geometry";
import { looks, type Passes, type Picture } from "./picture";
import { screenVertexShader, shadeFragmentShader } from "./shade_shaders";
import { SurfacePass } from "./surface_pass";
import {
  blendFragmentShader,
  blendVertexShader,
  depthFragmentShader,
  depthVertexShader,
  dotFragmentShader,
  dotVertexShader,
} from "./splat_shaders";

// Sizes of the shapes, in radii. Discs larger than those that hide what is behind them blend, up to where their kernels sum to minKernel:
// that closes gaps, and the notches of the silhouette between neighbouring discs.
const blendExtent = 1.1;
const blendDepth = 0.8; // how far behind the nearest disc others still blend, in radii along the ray
/// Gaps between discs of this scale and larger ones are closed: they are faults. Smaller discs show how the points lie.
const leastClosed = 0.5;
/// A projection that has every point in the middle of its picture.
const everything = new THREE.Matrix4().set(0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1);
/// The kernel of a disc where it ends in the picture.
const minKernel = 0.5 * (1 - (0.8 / blendExtent) ** 2) ** 3;

/// Whether the graphics card has floating point targets that blend, which the sums need.
export const canBlend = (renderer: THREE.WebGLRenderer): boolean =>
  renderer.extensions.has("EXT_color_buffer_float") || renderer.extensions.has("EXT_color_buffer_half_float");

/// Draws pictures, one after the other, on parts of one canvas. Precondition: canBlend().
export class SplatPasses implements Passes {
  readonly shape = "square";
  readonly drawsSurfaces = true;
  private target: THREE.WebGLRenderTarget | null = null; // of discs
  private drawn: THREE.WebGLRenderTarget | null = null; // the one drawn last
  private readonly surfaces: SurfacePass;
  private readonly textures = new ColourTextures();
  private readonly discUniforms = {
    ...makePointUniforms(),
    ...makeColourUniforms(),
    splatScale: { value: 1 },
    backShift: { value: 0 },
    extent: { value: 1 },
    minRadius: { value: 0 },
    frozenClip: { value: new THREE.Matrix4() },
    frozenEye: { value: new THREE.Vector4() },
    frozenSlim: { value: 0 },
  };
  private readonly dotUniforms = {
    ...makePointUniforms(),
    ...makeColourUniforms(),
    depths: { value: null as THREE.Texture | null },
    clip: { value: new THREE.Vector2() },
    tolerance: { value: 0.2 },
    diameter: { value: 3 },
    splatScale: { value: 1 },
    plainColour: { value: new THREE.Color() },
  };
  private readonly shadeUniforms = {
    normals: { value: null as THREE.Texture | null },
    colours: { value: null as THREE.Texture | null },
    depths: { value: null as THREE.Texture | null },
    origin: { value: new THREE.Vector2() },
    clip: { value: new THREE.Vector2() },
    isParallel: { value: false },
    halfSize: { value: new THREE.Vector2() },
    minKernel: { value: minKernel },
    isCovered: { value: false },
    closesGaps: { value: false },
    edlStrength: { value: 0 },
    edlReach: { value: 1 },
    sceneRadius: { value: 1 },
    clay: { value: new THREE.Color() },
    backTint: { value: new THREE.Color() },
    backgroundTop: { value: new THREE.Color() },
    backgroundBottom: { value: new THREE.Color() },
    isMatte: { value: false },
    brush: { value: new THREE.Vector4() },
    surfaceShift: { value: 0 },
  };
  private readonly depthMaterial = makeMaterial(depthVertexShader, depthFragmentShader, this.discUniforms, { colorWrite: false });
  private readonly blendMaterial = makeMaterial(blendVertexShader, blendFragmentShader, this.discUniforms, {
    depthWrite: false,
    blending: THREE.CustomBlending,
    blendSrc: THREE.OneFactor,
    blendDst: THREE.OneFactor,
  });
  /// Replaces both in quick pictures: each pixel shows its nearest disc.
  private readonly quickMaterial = makeMaterial(blendVertexShader, blendFragmentShader, this.discUniforms, {
    defines: { QUICK: "" },
  });
  private readonly dotMaterial = makeMaterial(dotVertexShader, dotFragmentShader, this.dotUniforms, {
    depthTest: false,
    depthWrite: false,
    transparent: true,
  });
  private readonly shadeMaterial = makeMaterial(screenVertexShader, shadeFragmentShader, this.shadeUniforms, {
    depthTest: false,
    depthWrite: false,
  });
  private readonly discs = new THREE.Mesh<THREE.BufferGeometry, THREE.Material>(new THREE.BufferGeometry(), this.depthMaterial);
  private readonly dots = new THREE.Points<THREE.BufferGeometry, THREE.Material>(new THREE.BufferGeometry(), this.dotMaterial);
  private readonly screen = new THREE.Mesh(new THREE.BufferGeometry(), this.shadeMaterial);
  private readonly noCamera = new THREE.Camera();

  constructor(private readonly renderer: THREE.WebGLRenderer) {
    this.surfaces = new SurfacePass(renderer);
    this.screen.geometry.setAttribute("position", new THREE.Float32BufferAttribute([-1, -1, 0, 3, -1, 0, -1, 3, 0], 3));
    this.screen.frustumCulled = false;
    this.discs.frustumCulled = false;
    this.dots.frustumCulled = false;
  }

  get depths(): THREE.Texture | null {
    return this.drawn?.depthTexture ?? null;
  }

  render(picture: Picture): void {
    const { renderer } = this;
    const { points, surface, style, where } = picture;
    this.drawn = surface ? this.surfaces.render(surface, picture) : this.renderDiscs(picture);
    this.prepareShading(picture, this.drawn);
    renderer.setRenderTarget(null);
    renderer.setViewport(where.x, where.y, where.width, where.height);
    renderer.setScissor(where.x, where.y, where.width, where.height);
    renderer.render(this.screen, this.noCamera);
    if (points && !surface && style.mode === "dots") {
      this.dots.geometry = points.dots;
      this.dots.position.copy(this.discs.position);
      renderer.render(this.dots, picture.camera);
    }
  }

  private renderDiscs(picture: Picture): THREE.WebGLRenderTarget {
    const { renderer, discs } = this;
    const { points, style, where } = picture;
    const isDots = style.mode === "dots";
    const hasColours = !isDots && (points?.scale.kind ?? 0) > 0;
    const target = this.targetOf(where.width, where.height, hasColours);
    this.prepareDiscs(picture, target);
    renderer.setRenderTarget(target);
    renderer.setClearColor(0x000000, 0);
    renderer.clear();
    if (!points) return target;
    discs.geometry = points.discs;
    discs.position.fromArray(points.store.origin);
    const pass = (material: THREE.Material, extent: number, backShift: number): void => {
      this.discUniforms.extent.value = extent;
      this.discUniforms.backShift.value = backShift;
      discs.material = material;
      renderer.render(discs, picture.camera);
    };
    if (picture.isQuick && !isDots) {
      pass(this.quickMaterial, hidingExtent, 0);
    } else {
      pass(this.depthMaterial, hidingExtent, blendDepth);
      if (!isDots || style.edl) pass(this.blendMaterial, blendExtent, 0);
    }
    return target;
  }

  dispose(): void {
    this.dropTarget();
    this.surfaces.dispose();
    this.textures.dispose();
    this.screen.geometry.dispose();
    for (const material of [this.depthMaterial, this.blendMaterial, this.quickMaterial, this.dotMaterial, this.shadeMaterial]) {
      material.dispose();
    }
  }

  private prepareDiscs(picture: Picture, target: THREE.WebGLRenderTarget): void {
    const { points, style, camera, where, pixelRatio } = picture;
    const [, halfHeight] = camera.halfSize;
    const [disc, dot] = [this.discUniforms, this.dotUniforms];

    disc.splatScale.value = dot.splatScale.value = style.splatScale * (points?.growth ?? 1);
    for (const material of [this.depthMaterial, this.blendMaterial, this.quickMaterial])
      define(material, "IS_FROZEN", picture.frozen !== null);
    if (picture.frozen) {
      const { camera: sampled, isCut, isEven } = picture.frozen;
      disc.frozenClip.value.copy(everything);
      if (isCut)
        disc.frozenClip.value.multiplyMatrices(sampled.projectionMatrix, sampled.matrixWorldInverse).multiply(camera.matrixWorld);
      disc.frozenEye.value.set(0, 0, sampled.isParallel ? 1 : 0, sampled.isParallel ? 0 : 1);
      disc.frozenEye.value.applyMatrix4(sampled.matrixWorld).applyMatrix4(camera.matrixWorldInverse);
      disc.frozenSlim.value = isEven ? slimness : 1e6;
    }
    // However it is turned, a square of this radius covers the middle of a pixel.
    disc.minRadius.value = (Math.SQRT1_2 * 2 * halfHeight) / where.height / hidingExtent;
    if (points) {
      for (const material of [this.depthMaterial, this.blendMaterial, this.quickMaterial]) {
        define(material, "HAS_ENDS", points.ends?.planes != null);
        define(material, "HAS_BENDS", points.ends?.bends != null);
      }
      for (const material of [this.depthMaterial, this.blendMaterial, this.quickMaterial, this.dotMaterial])
        define(material, "BOTH_SIDES", !points.store.isSurface);
      points.apply(disc, style.section);
      points.apply(dot, style.section);
      this.textures.apply(points.scale, disc);
      this.textures.apply(points.scale, dot);
      for (const material of [this.blendMaterial, this.quickMaterial]) define(material, "COLOURING", points.scale.kind);
      define(this.dotMaterial, "COLOURING", points.scale.kind);
    }

    dot.depths.value = target.depthTexture;
    dot.clip.value.set(camera.near, camera.far);
    dot.diameter.value = style.dotSize * pixelRatio;
    dot.plainColour.value = looks[style.background].dots;
  }

  private prepareShading(picture: Picture, target: THREE.WebGLRenderTarget): void {
    const { points, surface, style, camera, where, pixelRatio } = picture;
    const isDots = !surface && style.mode === "dots";
    const look = looks[style.background];
    const [halfWidth, halfHeight] = camera.halfSize;
    const shade = this.shadeUniforms;
    const hasColours = target.textures.length > 1;
    define(this.shadeMaterial, "HAS_COLOURS", hasColours);
    shade.depths.value = target.depthTexture;
    shade.normals.value = target.textures[0]!;
    shade.colours.value = target.textures[1] ?? null;
    shade.origin.value.set(where.x, where.y);
    shade.clip.value.set(camera.near, camera.far);
    shade.isCovered.value = surface !== null;
    shade.closesGaps.value = surface === null && style.splatScale >= leastClosed;
    shade.isParallel.value = camera.isParallel;
    shade.halfSize.value.set(halfWidth, halfHeight);
    shade.edlStrength.value = style.edl ? (isDots ? 0.5 : 1.1) : 0;
    shade.edlReach.value = Math.max(1, 1.3 * pixelRatio);
    shade.sceneRadius.value = picture.sceneRadius;
    shade.clay.value = isDots ? look.pale : look.clay;
    shade.backTint.value = isDots ? look.pale : look.back;
    shade.backgroundTop.value = look.top;
    shade.backgroundBottom.value = look.bottom;
    shade.isMatte.value = isDots || (hasColours && (surface !== null || points?.scale.isClay !== true));
    shade.surfaceShift.value = surface ? 0 : blendDepth * (points?.typicalRadius ?? 0) * this.discUniforms.splatScale.value;
    if (picture.brush) {
      const centre = picture.brush.centre.clone().applyMatrix4(camera.matrixWorldInverse);
      shade.brush.value.set(centre.x, centre.y, centre.z, picture.brush.radius);
    } else {
      shade.brush.value.w = 0;
    }
  }

  private targetOf(width: number, height: number, hasColours: boolean): THREE.WebGLRenderTarget {
    const count = hasColours ? 2 : 1;
    if (this.target?.textures.length !== count) {
      this.dropTarget();
      for (const material of [this.depthMaterial, this.blendMaterial, this.quickMaterial]) {
        define(material, "HAS_COLOURS", hasColours);
      }
      this.target = makeFloatTarget(width, height, count);
    }
    this.target.setSize(width, height);
    return this.target;
  }

  private dropTarget(): void {
    dropFloatTarget(this.target);
    this.target = this.drawn = null;
  }
}

function makeMaterial(
  vertexShader: string,
  fragmentShader: string,
  uniforms: Record<string, THREE.IUniform>,
  more: THREE.ShaderMaterialParameters,
): THREE.RawShaderMaterial {
  const glslVersion = THREE.GLSL3;
  return new THREE.RawShaderMaterial({
    vertexShader,
    fragmentShader,
    uniforms,
    glslVersion,
    side: THREE.DoubleSide,
    defines: {},
    ...more,
  });
}

/// Defines a constant of a material's shaders; false: undefines it.
function define(material: THREE.ShaderMaterial, name: string, value: number | boolean): void {
  const now = material.defines[name] as number | string | undefined;
  if (now === (value === true ? "" : value === false ? undefined : value)) return;
  if (value === false) Reflect.deleteProperty(material.defines, name);
  else material.defines[name] = value === true ? "" : value;
  material.needsUpdate = true;
}

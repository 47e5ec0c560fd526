classdef Actuator < dea.Object
  % A model of a design and its state, a voltage at a time.
  %
  %   a = dea.Actuator(design, 'lumped');
  %   a.solve(6000);                    stable equilibrium at 6 kV
  %   a.get('electrode_stretch')        a quantity of docs/results.md

  methods
    function self = Actuator(design, model)
      self.id = dea_mex('actuator_open', design.id, char(model));
    end

    function solve(self, voltage_V)
      % From the last point on. Error dea:no_equilibrium beyond pull-in.
      dea_mex('actuator_solve', self.id, voltage_V);
    end

    function indent(self, depth_m, radius_m, shape)
      % A rigid 'sphere' (also without SHAPE), 'flat' or 'cylinder' to a depth beyond touching.
      if nargin < 4
        shape = 'sphere';
      end
      dea_mex('actuator_indent', self.id, depth_m, radius_m, char(shape));
    end

    function value = get(self, key)
      % NaN if the model has no such quantity.
      value = dea_mex('actuator_get', self.id, char(key));
    end

    function found = mesh(self)
      % All fields at the last point, in the volume.
      found = dea_mex('actuator_mesh', self.id);
    end
  end
end

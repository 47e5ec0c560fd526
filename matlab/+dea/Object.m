classdef Object < handle
  % What dea_mex holds for a design, a result, an actuator or a solid; freed with its last copy.

  properties (SetAccess = protected, Hidden)
    id = 0;
  end

  methods
    function delete(self)
      if self.id > 0
        dea_mex('free', self.id);
      end
    end
  end
end
